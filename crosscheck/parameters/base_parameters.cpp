// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/parameters/base_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/exact/parameter_rank.hpp"
#include "crosscheck/parameters/certified_solve.hpp"
#include "crosscheck/scalars/formula_sizes.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/regressor.hpp"
#include "scene/work.hpp"
#include "symbolic/program.hpp"
#include "symbolic/regressor.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::Integer;
using scene::Rational;

// ---- from residues to rationals -----------------------------------------------------------------

/// An integer known modulo a product of primes.
struct Residue {
  Integer value = 0, modulus = 1;

  /// Takes the residue modulo one prime more (Chinese remainders).
  void add(std::uint64_t residue, std::uint64_t prime) {
    const PrimeField::Modulus field(prime);
    const auto mod = [](const Integer& x) {
      return PrimeField::fromResidue((x % PrimeField::modulus()).convert_to<std::uint64_t>());
    };
    const PrimeField step =
        (PrimeField::fromResidue(residue) - mod(value)) * mod(modulus).inverse();
    value += modulus * step.residue();
    modulus *= prime;
  }
  /// The fraction n/d of this residue with n^2 and d^2 below modulus/2, if there is one: a
  /// remainder of Euclid's algorithm.
  std::optional<Rational> fraction() const {
    Integer r_0 = modulus, r_1 = value, t_0 = 0, t_1 = 1;
    while (2 * r_1 * r_1 >= modulus) {
      const Integer quotient = r_0 / r_1;
      Integer next = r_0 - quotient * r_1;
      r_0 = r_1, r_1 = next;
      next = t_0 - quotient * t_1;
      t_0 = t_1, t_1 = next;
    }
    if (t_1 == 0 || 2 * t_1 * t_1 >= modulus) return {};
    return t_1 < 0 ? Rational(-r_1, -t_1) : Rational(r_1, t_1);
  }
};

// ---- in the scene's letters ---------------------------------------------------------------------

/// What a coefficient may be, in letters, and its value in the field.
struct Candidate {
  std::string text;
  PrimeField value;
};

/// "h + t" of "-h - t": without the sign in front, which a coefficient has of its own.
std::string withoutSign(const std::string& text) {
  if (text.empty() || text[0] != '-') return text;
  std::string out = text.substr(1);
  int depth = 0;
  for (std::size_t k = 0; k + 2 < out.size(); ++k) {
    depth += (out[k] == '(') - (out[k] == ')');
    if (depth != 0 || out[k] != ' ' || out[k + 2] != ' ') continue;
    if (out[k + 1] == '+' || out[k + 1] == '-') out[k + 1] = out[k + 1] == '+' ? '-' : '+';
  }
  return out;
}

/// Lengths of the scene that have letters in them, their squares, products and sums of two squares.
std::vector<Candidate> candidatesOf(const scene::Mechanism& mechanism, const FieldNumbers& number) {
  std::vector<Candidate> all, factors;  // factors in brackets where they need them
  const auto add = [&](const scene::Number& length) {
    if (length.parameters().empty()) return;
    const std::string text = withoutSign(length.text());
    const bool is_sum = text.find(' ') != std::string::npos;
    const std::string bracketed =
        text.find_first_of(" */^(") != std::string::npos ? "(" + text + ")" : text;
    if (std::any_of(factors.begin(), factors.end(),
                    [&](const Candidate& c) { return c.text == bracketed; }))
      return;
    const PrimeField value = number(scene::Number::parse(text));
    all.push_back({is_sum ? bracketed : text, value});
    factors.push_back({bracketed, value});
  };
  for (const scene::Link& link : mechanism.links) {
    for (const scene::Number& x : link.joint.placement.xyz) add(x);
    add(link.joint.placement.a);
    add(link.joint.placement.d);
  }
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const auto& [a, x] = factors[i];
    all.push_back({a + "^2", x * x});
    for (std::size_t j = i + 1; j < factors.size(); ++j) {
      const auto& [b, y] = factors[j];
      all.push_back({a + "*" + b, x * y});
      all.push_back({"(" + a + "^2 + " + b + "^2)", x * x + y * y});
    }
  }
  return all;
}

/** Names coefficients that are one of the candidates, or twice one, when the parameters of the
    scene are random elements. A wrong name passes with a chance of 1/p each. */
void nameCoefficients(const scene::Scene& scene, std::uint64_t seed, BaseParameters& base) {
  const PrimeField::Modulus field(drawPrime(scene.name, seed, 0));
  const FieldNumbers number(scene.mechanism, FieldSource(scene.name, seed, 0), Parameters::kRandom);
  const std::vector<Candidate> candidates = candidatesOf(scene.mechanism, number);
  if (candidates.empty()) return;
  const Echelon echelon =
      stackRegressor(scene, base.parameters, seed, 0, Parameters::kRandom).echelon;
  if (echelon.pivots() != base.independent) return;  // the scene's own numbers are special
  for (Coefficient& c : base.K) {
    const PrimeField value = echelon(c.base, c.parameter);
    for (const Candidate& candidate : candidates)
      for (const auto& [factor, text] : {std::pair(1, ""), std::pair(2, "2 ")})
        for (const auto& [sign, minus] : {std::pair(1, ""), std::pair(-1, "-")})
          if (c.symbol.empty() && candidate.value * PrimeField(sign * factor) == value)
            c.symbol = minus + (text + candidate.text);
  }
}

}  // namespace

int BaseParameters::countWithoutRotors() const {
  return static_cast<int>(std::count_if(independent.begin(), independent.end(), [&](int j) {
    return parameters[j].kind != scene::InertialParameter::Kind::kRotor;
  }));
}

BaseParameters baseParameters(const scene::Scene& scene, std::uint64_t seed,
                              double error_probability) {
  BaseParameters out;
  out.parameters = scene::inertialParameters(scene.mechanism);
  const int p = static_cast<int>(out.parameters.size());
  const double chance = chanceOfTooSmallRank(scene, out.parameters);
  if (!(chance < 1))
    throw std::runtime_error(scene.name + ": too large for a rank over primes below 2^63");
  const int trials = pointsNeeded(chance, error_probability);

  // enough trials for the rank, then as many as the rationals take, and one to hold them to
  constexpr int kMostTrials = 12;
  std::vector<Coefficient> found;
  std::vector<Residue> residues;
  bool lifted = false;
  for (int trial = 0; trial < trials || (!lifted && trial < kMostTrials); ++trial) {
    const PrimeField::Modulus field(drawPrime(scene.name, seed, trial));
    const std::uint64_t prime = PrimeField::modulus();
    const RegressorStack stack = stackRegressor(scene, out.parameters, seed, trial);
    const Echelon& echelon = stack.echelon;
    if (trial > 0 && echelon.pivots() != out.independent)
      throw std::runtime_error(scene.name + ": independent columns differ between two primes");
    out.points += stack.states;
    out.states = stack.states - 1;  // the last added nothing
    out.independent = echelon.pivots();
    std::vector<Coefficient> entries;
    for (int row = 0; row < echelon.rank(); ++row)
      for (int j = 0; j < p; ++j)
        if (j != out.independent[row] && !echelon(row, j).isZero()) entries.push_back({row, j, {}});
    if (trial > 0 && entries.size() != found.size())
      throw std::runtime_error(scene.name + ": coefficients are zero modulo one prime only");
    lifted = trial > 0;
    residues.resize(entries.size());
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const PrimeField here = echelon(entries[k].base, entries[k].parameter);
      if (trial > 0) {
        // what the primes before say, held to this one
        entries[k].exact = residues[k].fraction();
        if (entries[k].exact && PrimeField::fromRational(*entries[k].exact) != here)
          entries[k].exact.reset();
        lifted = lifted && entries[k].exact;
      }
      residues[k].add(here.residue(), prime);
    }
    found = std::move(entries);
  }
  out.K = std::move(found);
  out.error_probability = std::pow(chance, trials);
  encloseCoefficients(scene, seed, out);
  nameCoefficients(scene, seed, out);

  out.status.assign(p, BaseParameters::Status::kNoEffect);
  for (const int j : out.independent) out.status[j] = BaseParameters::Status::kAlone;
  for (const Coefficient& c : out.K)
    out.status[c.parameter] = out.status[out.independent[c.base]] =
        BaseParameters::Status::kInCombination;
  return out;
}

int energyRank(const scene::Scene& scene, const BaseParameters& base, std::uint64_t seed) {
  symbolic::InertialSymbols symbols = symbolic::inertialSymbols(scene.mechanism);
  const std::vector<symbolic::Node> energy = symbolic::energyRegressor(symbols);
  const symbolic::Program program = symbolic::compile(symbols.equations.graph, energy);
  const int trial = 0;
  const PrimeField::Modulus field(drawPrime(scene.name, seed, trial));
  const FieldNumbers number(symbols.mechanism, FieldSource(scene.name, seed, trial));
  symbolic::ProgramRun<PrimeField> run(program, number);
  const auto row = [&](int k) {
    return run(indeterminateState(scene.mechanism, regressorSource(scene, seed, trial, k)));
  };
  // K of this field
  const Echelon echelon = stackRegressor(scene, base.parameters, seed, trial).echelon;
  const int p = echelon.columns();
  const std::vector<PrimeField> reference = row(0);
  Echelon rank(eliminationOrder(base.parameters));
  scene::Work work("energy over the field", p + 1, 4);
  for (int k = 1; k <= p + 1; ++k, work.done()) {
    std::vector<PrimeField> change = row(k);
    for (int j = 0; j < p; ++j) change[j] -= reference[j];
    // of the energy, each dependent column must be the sum that it is of the forces
    std::vector<PrimeField> rest = change;
    for (int r = 0; r < echelon.rank(); ++r) {
      const PrimeField factor = change[base.independent[r]];
      for (int j = 0; j < p; ++j) rest[j] -= factor * echelon(r, j);
    }
    if (std::any_of(rest.begin(), rest.end(), [](PrimeField x) { return !x.isZero(); })) return -1;
    rank.add(change);
  }
  return rank.rank();
}

std::optional<int> mayedaCount(const scene::Mechanism& mechanism) {
  // a universal joint is two revolute ones, with no link between them that has parameters
  for (const scene::Link& link : mechanism.links)
    if (link.joint.kind != scene::JointKind::kRevolute &&
        link.joint.kind != scene::JointKind::kFixed)
      return {};
  const scene::RealNumbers<double> number(mechanism);
  const auto model = recursive::buildModel(mechanism, number);
  int parallel = 0;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const auto& link = model.links[i];
    if (link.parent != static_cast<int>(i) - 1) return {};
    const double cosine = i == 0 ? 1 : link.X_tree.R(2, 2);  // between this axis and the last
    if (cosine != 0 && std::abs(cosine) != 1) return {};
    if (cosine != 0 && parallel == static_cast<int>(i)) ++parallel;
  }
  if (model.links.empty()) return {};
  const Eigen::Vector3d g = model.links[0].X_tree.R * model.gravity;
  const bool turned_by_gravity = g.x() != 0 || g.y() != 0;
  return 7 * model.dof() - 4 * parallel - (turned_by_gravity ? 0 : 2);
}

std::string text(const Coefficient& coefficient) {
  if (!coefficient.symbol.empty()) return coefficient.symbol;
  if (!coefficient.exact) return fmt::format("{:.6g}", coefficient.value);
  const Rational& r = *coefficient.exact;
  if (denominator(r) == 1) return r.str();
  // a short decimal if it is one
  Rational scaled = r;
  for (int places = 1; places <= 8; ++places)
    if (denominator(Rational(scaled *= 10)) == 1)
      return fmt::format("{:.{}f}", coefficient.value, places);
  const std::string fraction = r.str();
  return fraction.size() <= 9 ? fraction : fmt::format("{:.6g}", coefficient.value);
}

std::string combination(const BaseParameters& base, int row, const scene::Mechanism& mechanism) {
  struct Term {  // the same multiple of the same number of several links
    std::string coefficient;
    scene::InertialParameter::Kind kind;
    std::vector<std::string> labels;
  };
  std::vector<Term> terms;
  for (const Coefficient& c : base.K) {
    if (c.base != row) continue;
    const std::string factor = text(c);
    const auto kind = base.parameters[c.parameter].kind;
    const auto same = std::find_if(terms.begin(), terms.end(), [&](const Term& term) {
      return term.coefficient == factor && term.kind == kind;
    });
    Term& term = same == terms.end() ? terms.emplace_back(Term{factor, kind, {}}) : *same;
    term.labels.push_back(scene::label(base.parameters[c.parameter], mechanism));
  }
  std::string out = scene::label(base.parameters[base.independent[row]], mechanism);
  for (const auto& [coefficient, kind, labels] : terms) {
    const bool negative = coefficient[0] == '-';
    const std::string factor = negative ? coefficient.substr(1) : coefficient;
    const std::string sign = negative ? " - " : " + ";
    if (factor == "1") {
      for (const std::string& label : labels) out += sign + label;
      continue;
    }
    std::string sum;
    for (const std::string& label : labels) sum += (sum.empty() ? "" : " + ") + label;
    out += sign + factor + " " + (labels.size() > 1 ? "[" + sum + "]" : sum);
  }
  return out;
}

}  // namespace dynwitness::crosscheck
