// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/exact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/lagrange.hpp"
#include "recursive/constraints.hpp"
#include "scene/work.hpp"
#include "symbolic/closures.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Points without a value in a row before a check is given up: a divisor that is not zero as a
/// formula vanishes at a point with the chance r of errorProbability(), at all of these with r^8.
/// Giving up costs an answer; it never gives a wrong one.
constexpr int kPatience = 8;

// ---- deciding -----------------------------------------------------------------------------------

/// One check on its way to a verdict.
class Trial {
 public:
  Trial(CheckResult check, const ExactOptions& options) : check_(std::move(check)) {
    check_.unit = Unit::kExact;
    check_.seed = options.seed;
    exact_.parameters = name(options.parameters);
  }

  /// How many points it takes, from the size of the formulas.
  void size(const TwoSides<PrimeField>& sides, const FormulaSizes& sizes, double target) {
    check_.is_idle = sides.is_idle;
    if (!sides.failure.empty()) return giveUp(sides.failure, true);
    if (!sameShape(sides)) return;
    rows_ = sides.left.rows(), columns_ = sides.left.cols();
    double chance = 0;
    for (Eigen::Index j = 0; j < sides.left.cols(); ++j) {
      for (Eigen::Index i = 0; i < sides.left.rows(); ++i) {
        const PrimeField difference = sides.left(i, j) - sides.right(i, j);
        exact_.degree = std::max(exact_.degree, difference.degree());
        chance = std::max(chance, errorProbability(difference, sizes));
      }
    }
    if (!(chance < 1))
      return giveUp(
          fmt::format("a degree of up to {:.2g} is too large for primes below 2^63", exact_.degree),
          false);
    chance_ = chance;
    needed_ = pointsNeeded(chance, target);
  }

  void add(int index, const TwoSides<PrimeField>& sides) {
    if (done_) return;
    exact_.prime = PrimeField::modulus();
    if (!sides.failure.empty()) {
      ++exact_.discarded;
      if (++discarded_in_a_row == kPatience)
        giveUp(fmt::format("no value at {} points: {}", kPatience, sides.failure), true);
      return;
    }
    discarded_in_a_row = 0;
    ++exact_.points;
    if (!sameShape(sides)) return;
    if (sides.left.rows() != rows_ || sides.left.cols() != columns_)  // as what was not asked has
      return disagree(fmt::format("at point {} it has {} x {} entries, and {} x {} as a formula",
                                  index, sides.left.rows(), sides.left.cols(), rows_, columns_));
    for (Eigen::Index j = 0; j < sides.left.cols(); ++j) {
      for (Eigen::Index i = 0; i < sides.left.rows(); ++i) {
        if (sides.left(i, j) == sides.right(i, j)) continue;
        check_.worst_entry = entryName(check_.quantity, i, j, sides.left);
        check_.worst_state = index;
        return disagree(fmt::format(
            "{} differs at point {} of seed {}: {} and {} modulo {}", check_.worst_entry, index,
            check_.seed, sides.left(i, j).residue(), sides.right(i, j).residue(), exact_.prime));
      }
    }
    done_ = exact_.points == needed_;
  }

  bool done() const { return done_; }
  int needed() const { return needed_; }  ///< points
  CheckResult result() const {
    CheckResult out = check_;
    out.states = std::max(exact_.points, out.voided);
    if (out.verdict == Verdict::kNotAnswerable) return out;
    out.exact = exact_;
    out.exact->residual_zero = out.verdict == Verdict::kAgree;
    out.exact->error_probability = std::pow(chance_, exact_.points);
    return out;
  }

 private:
  /// @param has_none  there is no number to compare: a divisor is zero as a formula, or there is no
  ///   law
  void giveUp(const std::string& reason, bool has_none) {
    check_.addVoided(0, reason, has_none);
    check_.verdict = Verdict::kNotAnswerable;
    check_.reason = reason;
    done_ = true;
  }
  void disagree(const std::string& reason) {
    check_.verdict = Verdict::kDisagree;
    check_.reason = reason;
    check_.ratio = check_.worst = std::numeric_limits<double>::infinity();
    done_ = true;
  }
  bool sameShape(const TwoSides<PrimeField>& sides) {
    const bool same =
        sides.left.rows() == sides.right.rows() && sides.left.cols() == sides.right.cols();
    if (!same)
      disagree(fmt::format("shapes differ: {} x {} and {} x {}", sides.left.rows(),
                           sides.left.cols(), sides.right.rows(), sides.right.cols()));
    return same;
  }

  CheckResult check_;
  CheckResult::Exact exact_;
  Eigen::Index rows_ = 0, columns_ = 0;
  double chance_ = 0;
  int needed_ = 1, discarded_in_a_row = 0;
  bool done_ = false;
};

}  // namespace

std::vector<CheckResult> decide(const scene::Scene& scene, const Inquiry& inquiry,
                                const ExactOptions& options) {
  std::vector<Trial> trials;
  for (const CheckResult& check : inquiry.checks) trials.emplace_back(check, options);
  const auto ask = [&](int index) {
    const FieldSource source(scene.name, options.seed, index);
    SidesOfAll sides(trials.size());
    try {
      const FieldNumbers number(scene.mechanism, source, options.parameters);
      scene::State<PrimeField> state =
          indeterminateState(scene.mechanism, source, options.parameters);
      if (options.at) options.at(number, state);
      std::vector<char> wanted;
      for (const Trial& trial : trials) wanted.push_back(trial.done() ? 0 : 1);
      sides = inquiry.ask(number, state, wanted);
    } catch (const DivisionByZero& error) {  // sized: as a formula; else the prime divides a number
      for (TwoSides<PrimeField>& failed : sides) failed.failure = error.what();
    }
    return sides;
  };
  {
    const FormulaSizes sizes;
    const SidesOfAll sides = ask(0);
    for (std::size_t i = 0; i < trials.size(); ++i)
      trials[i].size(sides[i], sizes, options.error_probability);
  }
  int points = 1;
  for (const Trial& trial : trials) points = std::max(points, trial.needed());
  scene::Work work("formulas over prime fields", points);
  const auto isDone = [](const Trial& trial) { return trial.done(); };
  for (int index = 0; !std::all_of(trials.begin(), trials.end(), isDone); ++index, work.done()) {
    const PrimeField::Modulus modulus(drawPrime(scene.name, options.seed, index));
    const SidesOfAll sides = ask(index);
    for (std::size_t i = 0; i < trials.size(); ++i) trials[i].add(index, sides[i]);
  }
  std::vector<CheckResult> results;
  for (const Trial& trial : trials) results.push_back(trial.result());
  return results;
}

namespace {

// ---- comparisons --------------------------------------------------------------------------------

/// Every quantity and every pair of witnesses that answer it.
struct Pair {
  Quantity quantity;
  std::size_t left, right;
};

std::vector<Pair> pairsOf(const std::vector<ExactWitness>& witnesses) {
  std::vector<Pair> pairs;
  for (const Quantity quantity : kAllQuantities)
    for (std::size_t a = 0; a < witnesses.size(); ++a)
      for (std::size_t b = a + 1; b < witnesses.size(); ++b)
        if (witnesses[a].answers(quantity) && witnesses[b].answers(quantity))
          pairs.push_back({quantity, a, b});
  return pairs;
}

/// What all witnesses say about all quantities, asked once each, then pair by pair.
SidesOfAll ask(const std::vector<Pair>& pairs, const std::vector<ExactWitness::Answers>& witnesses,
               const scene::State<PrimeField>& state, const std::vector<char>& wanted) {
  struct Testimony {
    MatrixX<PrimeField> answer;
    std::string failure;
  };
  std::map<std::pair<Quantity, std::size_t>, Testimony> said;
  const auto hear = [&](Quantity quantity, std::size_t witness) -> const Testimony& {
    const auto [it, is_new] = said.try_emplace({quantity, witness});
    if (is_new) {
      try {
        it->second.answer = witnesses[witness](quantity, state);
      } catch (const DivisionByZero& error) {
        it->second.failure = error.what();
      }
    }
    return it->second;
  };
  SidesOfAll all;
  for (const Pair& pair : pairs) {
    if (wanted[all.size()] == 0) {
      all.emplace_back();
      continue;
    }
    const Testimony &left = hear(pair.quantity, pair.left),
                    &right = hear(pair.quantity, pair.right);
    all.push_back({left.answer, right.answer, left.failure.empty() ? right.failure : left.failure});
  }
  return all;
}

}  // namespace

Inquiry comparisonInquiry(const std::vector<ExactWitness>& witnesses) {
  const std::vector<Pair> pairs = pairsOf(witnesses);
  Inquiry inquiry;
  for (const Pair& pair : pairs) {
    const ExactWitness &left = witnesses[pair.left], &right = witnesses[pair.right];
    CheckResult check = sameInWords(name(pair.quantity), left.name, right.name);
    check.left_is_control = left.is_control;
    check.right_is_control = right.is_control;
    inquiry.checks.push_back(check);
  }
  inquiry.ask = [=](const FieldNumbers& number, const scene::State<PrimeField>& state,
                    const std::vector<char>& wanted) {
    std::vector<char> heard(witnesses.size(), 0);
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (wanted[k] != 0) heard[pairs[k].left] = heard[pairs[k].right] = 1;
    std::vector<ExactWitness::Answers> built;
    for (std::size_t w = 0; w < witnesses.size(); ++w)
      built.push_back(heard[w] != 0 ? witnesses[w].in_field(number) : ExactWitness::Answers());
    return ask(pairs, built, state, wanted);
  };
  return inquiry;
}

namespace {

// ---- closures -----------------------------------------------------------------------------------

/// phi, J and gamma, derived from phi and from the sweeps.
Inquiry closures(const scene::Mechanism& mechanism, const DerivedPrograms& of) {
  constexpr int kParts = 3;
  constexpr const char* kNames[kParts] = {"phi", "J", "gamma"};
  constexpr const char* kStatements[kParts] = {
      "closures: phi by lagrange = phi by the sweeps",
      "closures: J = dphi/dq by lagrange = J by the sweeps",
      "closures: (dJ/dt) qd by lagrange = by the sweeps"};
  Inquiry inquiry;
  for (int k = 0; k < kParts; ++k) {
    CheckResult check;
    check.law = "closures";
    check.statement = kStatements[k];
    check.quantity = kNames[k];
    check.left = "lagrange";
    check.right = "sweeps";
    inquiry.checks.push_back(check);
  }
  symbolic::Equations& equations = of.forces();
  const symbolic::ClosureEquations derived =
      symbolic::closureEquations(of.mechanism(), of.options(), equations);
  std::vector<symbolic::Node> outputs = derived.phi;
  for (const auto& row : derived.J) outputs.insert(outputs.end(), row.begin(), row.end());
  outputs.insert(outputs.end(), derived.gamma.begin(), derived.gamma.end());
  const auto program =
      std::make_shared<const symbolic::Program>(symbolic::compile(equations.graph, outputs));
  inquiry.ask = [program, &mechanism](const FieldNumbers& number,
                                      const scene::State<PrimeField>& state,
                                      const std::vector<char>&) {
    using T = PrimeField;
    SidesOfAll all(kParts);
    try {
      const auto model = recursive::buildModel(mechanism, number);
      recursive::Workspace<T> ws(model);
      auto sweeps = recursive::buildConstraints(mechanism, number, model);
      recursive::constraintEquations(model, state.x, state.qd, ws, sweeps);
      const std::vector<T> values = symbolic::ProgramRun<T>(*program, number)(state);
      const Eigen::Index m = sweeps.rows(), n = model.dof();
      const MatrixX<T> right[kParts] = {sweeps.phi, sweeps.J, sweeps.gamma};
      const T* from = values.data();
      for (int k = 0; k < kParts; ++k) {
        const Eigen::Index columns = k == 1 ? n : 1;
        all[k].right = right[k];
        all[k].left.resize(m, columns);
        for (Eigen::Index i = 0; i < m; ++i)
          for (Eigen::Index j = 0; j < columns; ++j) all[k].left(i, j) = *from++;
      }
    } catch (const DivisionByZero& error) {
      for (TwoSides<T>& failed : all) failed.failure = error.what();
    }
    return all;
  };
  return inquiry;
}

}  // namespace

Inquiry both(const Inquiry& a, const Inquiry& b) {
  Inquiry inquiry{a.checks, {}};
  inquiry.checks.insert(inquiry.checks.end(), b.checks.begin(), b.checks.end());
  inquiry.ask = [a, b](const FieldNumbers& number, const scene::State<PrimeField>& state,
                       const std::vector<char>& wanted) {
    const auto middle = wanted.begin() + static_cast<std::ptrdiff_t>(a.checks.size());
    const auto of = [&](const Inquiry& one, const std::vector<char>& of_one) {
      return std::count(of_one.begin(), of_one.end(), 0) == static_cast<long>(of_one.size())
                 ? SidesOfAll(of_one.size())
                 : one.ask(number, state, of_one);
    };
    SidesOfAll sides = of(a, {wanted.begin(), middle});
    for (auto& more : of(b, {middle, wanted.end()})) sides.push_back(std::move(more));
    return sides;
  };
  return inquiry;
}

std::vector<ExactWitness> exactWitnesses(const PreparedScene& scene, Parameters parameters,
                                         const std::vector<WitnessKind>& kinds) {
  std::vector<ExactWitness> witnesses;
  for (const WitnessKind& kind : kinds) {
    if (!kind.make_exact) continue;
    OrRefusal<ExactWitness> made = kind.make_exact(scene, parameters);
    if (!made.isRefused()) witnesses.push_back(std::move(made).value());
  }
  return witnesses;
}

std::vector<CheckResult> compareExactly(const scene::Scene& scene,
                                        const std::vector<ExactWitness>& witnesses,
                                        const ExactOptions& options) {
  return decide(scene, comparisonInquiry(witnesses), options);
}

std::vector<CheckResult> checkIdentitiesExactly(const scene::Scene& scene,
                                                const ExactOptions& options) {
  return decide(scene, identityInquiry(scene.mechanism), options);
}

std::vector<CheckResult> checkClosuresExactly(const scene::Scene& scene,
                                              const ExactOptions& options,
                                              const scene::Mechanism* derived) {
  return checkClosuresExactly(scene, options,
                              DerivedPrograms(derived ? *derived : scene.mechanism,
                                              options.parameters == Parameters::kAsWritten));
}

std::vector<CheckResult> checkClosuresExactly(const scene::Scene& scene,
                                              const ExactOptions& options,
                                              const DerivedPrograms& derived) {
  if (scene.mechanism.closures.empty()) return {};
  return decide(scene, closures(scene.mechanism, derived), options);
}

std::string describeExact(const CheckResult::Exact& exact) {
  if (!exact.residual_zero) return fmt::format("residual not zero modulo {}", exact.prime);
  return fmt::format(
      "residual zero at {} points modulo 63-bit primes; chance that different formulas pass at "
      "most "
      "{:.1e}",
      exact.points, exact.error_probability);
}

}  // namespace dynwitness::crosscheck
