// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/judge_formulas.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/scalars/formula_sizes.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "symbolic/closed_form.hpp"
#include "symbolic/exact_points.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {
namespace {

using symbolic::Node;
using symbolic::Rational;
using Read = StatedLanguage::Read;

/// That a wrong formula passes.
constexpr double kChance = 1e-18;

/// At so many points in a row a formula has no value before it is said to have none.
constexpr int kMostTries = 20;
[[noreturn]] void throwDivisionByZero() {
  throw scene::InputError({}, "one of the formulas divides by 0 wherever it is tried");
}

/// What a formula may be, as a claim that holds at every point or does not.
struct Claim {
  FormulaRelation relation;
  Rational factor = 1;  ///< kMultiple: stated = factor parameter^exponent derived
  int parameter = -1, exponent = 0;
  int quantity = -1;  ///< kAnotherQuantity: factor 1 or -1 of it
  bool holds = true;
};

/// The values of all nodes at one point.
template <typename T>
struct Values {
  std::vector<T> derived, stated, quantities, parameters;
  std::vector<T> derived_elsewhere, stated_elsewhere;  ///< same parameters, another state
};

/// All formulas, and all that they are compared with, as one program.
class Compared {
 public:
  Compared(const scene::Mechanism& mechanism, const StatedLanguage& language,
           const std::vector<Read>& reads)
      : mechanism_(mechanism), formulas_(reads.size()) {
    std::vector<Node> nodes;
    for (const Read& read : reads) nodes.push_back(read.derived);
    for (const Read& read : reads) nodes.push_back(read.stated);
    for (const auto& entry : language.quantities()) nodes.push_back(entry.second);
    program_ = symbolic::compile(language.equations().graph, nodes);
  }

  template <typename T, typename Numbers>
  Values<T> at(const Numbers& number, const scene::State<T>& state,
               const scene::State<T>& elsewhere) const {
    symbolic::ProgramRun<T> run(program_, number);
    const auto part = [](const std::vector<T>& all, std::size_t from, std::size_t to) {
      return std::vector<T>(all.begin() + static_cast<std::ptrdiff_t>(from),
                            all.begin() + static_cast<std::ptrdiff_t>(to));
    };
    const std::vector<T> here = run(state), there = run(elsewhere);
    Values<T> values;
    values.derived = part(here, 0, formulas_);
    values.stated = part(here, formulas_, 2 * formulas_);
    values.quantities = part(here, 2 * formulas_, here.size());
    values.derived_elsewhere = part(there, 0, formulas_);
    values.stated_elsewhere = part(there, formulas_, 2 * formulas_);
    for (const scene::Parameter& p : mechanism_.parameters)
      values.parameters.push_back(number(scene::Number::parse(p.name)));
    return values;
  }

  /// Over the field of the innermost scope.
  Values<PrimeField> at(const std::string& name, std::uint64_t seed, std::uint64_t index,
                        Parameters parameters) const {
    const FieldSource source(name, seed, index), other(name + " elsewhere", seed, index);
    return at<PrimeField>(FieldNumbers(mechanism_, source, parameters),
                          indeterminateState(mechanism_, source, parameters),
                          indeterminateState(mechanism_, other, parameters));
  }

  /// In rational numbers, which are no proof and lead to claims.
  Values<Rational> rational() const {
    for (int seed = 1; seed <= kMostTries; ++seed) {
      try {
        return at<Rational>(
            symbolic::ExactNumbers(mechanism_),
            symbolic::exactState(mechanism_.dof(), static_cast<unsigned>(2 * seed)),
            symbolic::exactState(mechanism_.dof(), static_cast<unsigned>(2 * seed + 1)));
      } catch (const std::overflow_error&) {  // what Boost calls a division by 0
      }
    }
    throwDivisionByZero();
  }

 private:
  const scene::Mechanism& mechanism_;
  const std::size_t formulas_;
  symbolic::Program program_;
};

template <typename T>
T raised(const T& base, int exponent) {
  T result(1);
  for (int k = 0; k < std::abs(exponent); ++k) result = result * base;
  return exponent < 0 ? T(T(1) / result) : result;
}

/// What formula i may be: the claims that hold at one rational point, in the order of their names.
std::vector<Claim> claimsOf(std::size_t i, const std::string& name, const Values<Rational>& v) {
  std::vector<Claim> claims{{FormulaRelation::kEqual}};
  if (name == "V") claims.push_back({FormulaRelation::kUpToConstant});
  claims.push_back({FormulaRelation::kNegative, -1});
  const Rational &derived = v.derived[i], &stated = v.stated[i];
  if (stated == 0) return claims;
  if (derived != 0 && stated * v.derived_elsewhere[i] == v.stated_elsewhere[i] * derived) {
    const Rational ratio = stated / derived;
    claims.push_back({FormulaRelation::kMultiple, ratio});
    for (std::size_t p = 0; p < v.parameters.size(); ++p)
      for (const int exponent : {1, -1, 2, -2})
        if (v.parameters[p] != 0)
          claims.push_back({FormulaRelation::kMultiple, ratio / raised(v.parameters[p], exponent),
                            static_cast<int>(p), exponent});
  }
  for (std::size_t k = 0; k < v.quantities.size(); ++k)
    for (const int sign : {1, -1})
      if (v.quantities[k] != 0 && stated == sign * v.quantities[k])
        claims.push_back({FormulaRelation::kAnotherQuantity, sign, -1, 0, static_cast<int>(k)});
  return claims;
}

bool holdsAt(const Claim& claim, std::size_t i, const Values<PrimeField>& v) {
  switch (claim.relation) {
    case FormulaRelation::kUpToConstant:
      return v.stated[i] - v.derived[i] == v.stated_elsewhere[i] - v.derived_elsewhere[i];
    case FormulaRelation::kAnotherQuantity:
      return v.stated[i] == PrimeField::fromRational(claim.factor) *
                                v.quantities[static_cast<std::size_t>(claim.quantity)];
    default:
      break;
  }
  PrimeField right = PrimeField::fromRational(claim.factor) * v.derived[i];
  if (claim.parameter >= 0)
    right = right * raised(v.parameters[static_cast<std::size_t>(claim.parameter)], claim.exponent);
  return v.stated[i] == right;
}

/// Chance that a claim about one of the formulas holds at one point and is wrong.
/// @throws scene::InputError  one divides by what is 0 as a formula
double chanceOf(const Compared& compared, const std::string& name, std::size_t formulas) {
  const FormulaSizes sizes;
  Values<PrimeField> v;
  try {
    v = compared.at(name, 0, 0, Parameters::kRandom);
  } catch (const DivisionByZero&) {
    throwDivisionByZero();
  }
  double chance = 0;
  for (std::size_t i = 0; i < formulas; ++i) {
    // no claim multiplies by more than the square of a parameter, which has weight 1
    const PrimeField factor = FormulaSizes::indeterminate(2);
    for (const PrimeField& right : {v.derived[i] * factor, v.derived_elsewhere[i]})
      chance = std::max(chance, errorProbability(v.stated[i] * factor - right, sizes));
    for (const PrimeField& quantity : v.quantities)
      chance = std::max(chance, errorProbability(v.stated[i] - quantity, sizes));
  }
  return chance;
}

std::string factorText(const Claim& claim, const scene::Mechanism& mechanism) {
  using symbolic::Formula;
  std::vector<Formula> factors;
  if (abs(claim.factor) != 1 || claim.parameter < 0)
    factors.push_back(Formula::ofNumber(abs(claim.factor)));
  if (claim.parameter >= 0)
    factors.push_back(Formula::power(
        Formula::ofSymbol(mechanism.parameters[static_cast<std::size_t>(claim.parameter)].name),
        claim.exponent));
  const std::string text = print(Formula::product(factors), symbolic::Style::kText);
  return claim.factor < 0 ? "-" + text : text;
}

/// Where two formulas differ, term by term.
class Terms {
 public:
  explicit Terms(const symbolic::Equations& equations)
      : equations_(equations), algebra_(equations), known_(equations.graph.size()) {}

  void tell(const Read& read, JudgedFormula* to) {
    if (const char* why = refusal(read)) {
      to->no_gaps = why;
      return;
    }
    for (const auto& gap :
         algebra_.termGaps(algebra_.expression(read.derived), algebra_.expression(read.stated)))
      to->gaps.push_back({print(gap.term, symbolic::Style::kText), gap.derived, gap.stated});
  }

 private:
  /// Terms before any are put together: a bound of what expanding takes. tau1 of puma_560 is within
  /// it and takes 2 s, that of franka_panda is not.
  static constexpr double kMostTerms = 20000;

  const char* refusal(const Read& read) {
    if (!isNameable(read.derived)) return "the scene's own formula divides by its parameters";
    if (!isNameable(read.stated))
      return "it divides by parameters, or has an angle that the scene has not";
    if (terms(read.derived) > kMostTerms || terms(read.stated) > kMostTerms)
      return "expanded, there are too many to read";
    return nullptr;
  }

  bool isNameable(Node node) {
    const auto [it, is_new] = nameable_.emplace(node.index, true);
    if (!is_new) return it->second;
    const symbolic::Graph& graph = equations_.graph;
    const symbolic::Op op = graph.op(node);
    bool nameable =
        op != symbolic::Op::kInverse && (op != symbolic::Op::kAtom || node.index < known_);
    if (graph.operandCount(node) > 0) nameable = nameable && isNameable(graph.left(node));
    if (graph.operandCount(node) > 1) nameable = nameable && isNameable(graph.right(node));
    return nameable_[node.index] = nameable;
  }

  double terms(Node node) {
    const auto [it, is_new] = terms_.emplace(node.index, 1);
    if (!is_new) return it->second;
    const symbolic::Graph& graph = equations_.graph;
    double count = 1;
    if (graph.operandCount(node) > 0) count = terms(graph.left(node));
    if (graph.operandCount(node) > 1) {
      const double right = terms(graph.right(node));
      count = graph.op(node) == symbolic::Op::kMultiply ? count * right : count + right;
    }
    return terms_[node.index] = count;
  }

  const symbolic::Equations& equations_;
  symbolic::ClosedAlgebra algebra_;
  const int known_;  ///< nodes that are older than the algebra
  std::map<int, bool> nameable_;
  std::map<int, double> terms_;
};

}  // namespace

bool JudgedFormulas::isRight() const {
  return std::all_of(formulas.begin(), formulas.end(),
                     [](const JudgedFormula& f) { return f.isRight(); });
}

namespace {

/// Strikes the claims that do not hold at as many points as the chance takes.
/// @return how many points these are
int strike(const Compared& compared, const std::string& name, std::uint64_t seed, double chance,
           Parameters parameters, std::vector<std::vector<Claim>>* claims) {
  const int points = pointsNeeded(chance, kChance);
  for (int done = 0, index = 0; done < points; ++index) {
    if (index == points + kMostTries) throwDivisionByZero();
    const auto at = static_cast<std::uint64_t>(index);
    const PrimeField::Modulus modulus(drawPrime(name, seed, at));
    try {
      const Values<PrimeField> v = compared.at(name, seed, at, parameters);
      for (std::size_t i = 0; i < claims->size(); ++i)
        for (Claim& claim : (*claims)[i]) claim.holds = claim.holds && holdsAt(claim, i, v);
      ++done;
    } catch (const DivisionByZero&) {  // another point is drawn
    }
  }
  return points;
}

void conclude(const std::vector<Claim>& claims, const scene::Mechanism& mechanism,
              const StatedLanguage& language, JudgedFormula* to) {
  for (const Claim& claim : claims) {
    if (!claim.holds) continue;
    to->relation = claim.relation;
    if (claim.relation == FormulaRelation::kMultiple) to->factor = factorText(claim, mechanism);
    if (claim.relation == FormulaRelation::kAnotherQuantity)
      to->another = (claim.factor < 0 ? "-" : "") +
                    language.quantities()[static_cast<std::size_t>(claim.quantity)].first;
    return;
  }
}

}  // namespace

JudgedFormulas judgeFormulas(const scene::Scene& scene, const std::vector<StatedFormula>& formulas,
                             std::uint64_t seed) {
  const scene::Mechanism& mechanism = scene.mechanism;
  StatedLanguage language(mechanism);
  Terms terms(language.equations());
  std::vector<Read> reads;
  JudgedFormulas out;
  out.scene = scene.name;
  for (const StatedFormula& formula : formulas) {
    reads.push_back(language.read(formula));
    JudgedFormula one;
    one.text = reads.back().text;
    one.name = reads.back().name;
    out.formulas.push_back(one);
  }
  const Compared compared(mechanism, language, reads);
  const double chance = chanceOf(compared, scene.name, reads.size());
  const Values<Rational> somewhere = compared.rational();
  std::vector<std::vector<Claim>> claims, of_this_scene;
  for (std::size_t i = 0; i < reads.size(); ++i) {
    claims.push_back(claimsOf(i, reads[i].name, somewhere));
    of_this_scene.push_back({{FormulaRelation::kForThisScene}});
  }
  out.points = strike(compared, scene.name, seed, chance, Parameters::kRandom, &claims);
  out.chance = std::pow(chance, out.points);
  strike(compared, scene.name, seed, chance, Parameters::kAsWritten, &of_this_scene);
  for (std::size_t i = 0; i < reads.size(); ++i) {
    claims[i].insert(claims[i].begin() + 1, of_this_scene[i][0]);
    conclude(claims[i], mechanism, language, &out.formulas[i]);
    if (!out.formulas[i].isRight()) terms.tell(reads[i], &out.formulas[i]);
  }
  return out;
}

}  // namespace dynwitness::crosscheck
