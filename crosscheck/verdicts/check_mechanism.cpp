// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/check_mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/motion/closed_states.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/verdicts/tally.hpp"

namespace dynwitness::crosscheck {
namespace {

using Asked = MechanismQuantity;

/// What a mechanism has.
std::vector<Asked> quantitiesOf(const scene::Mechanism& mechanism) {
  const bool is_closed = !mechanism.closures.empty(),
             is_held = !mechanism.acceleration_constraints.empty();
  std::vector<Asked> out = {Asked::kQdd};
  if (is_closed || is_held) out.push_back(Asked::kConstraintForce);
  if (is_closed) out.push_back(Asked::kLambda);
  if (is_held) out.push_back(Asked::kNu);
  if (mechanism.isDriven()) out.push_back(Asked::kDrive);
  if (mechanism.links.size() > 1) out.push_back(Asked::kReactions);
  return out;
}

const char* words(Asked quantity) {
  switch (quantity) {
    case Asked::kQdd:
      return "qdd of the whole mechanism";
    case Asked::kConstraintForce:
      return "J' lambda, joint forces of all constraints,";
    case Asked::kLambda:
      return "lambda of the closures";
    case Asked::kNu:
      return "nu of the acceleration constraints";
    case Asked::kDrive:
      return "force of the drives";
    case Asked::kReactions:
      return "reactions of the joints of the whole mechanism";
  }
  return "?";
}

/// Whose reactions redundant closures leave open: "reactions of a, b"; of every joint all six or
/// some of them: "reactions of all joints", "some reactions of all joints".
std::string openReactions(const scene::Mechanism& mechanism, const std::vector<char>& determined) {
  std::string names;
  std::size_t joint = 0, open = 0;
  const bool are_all = std::find(determined.begin(), determined.end(), 1) == determined.end();
  for (const scene::Link& link : mechanism.links) {
    if (link.parent < 0) continue;
    const auto from = determined.begin() + static_cast<std::ptrdiff_t>(6 * joint++);
    if (std::find(from, from + 6, 0) == from + 6) continue;
    ++open;
    names += (names.empty() ? "" : ", ") + link.joint.name;
  }
  if (open == joint) names = "all joints";
  return (open == joint && !are_all ? "some reactions of " : "reactions of ") + names;
}

/// Those that are determined.
Eigen::VectorXd determinedOf(const Eigen::VectorXd& all, const std::vector<char>& determined) {
  if (determined.empty()) return all;
  std::vector<double> kept;
  for (std::size_t i = 0; i < determined.size(); ++i)
    if (determined[i]) kept.push_back(all(static_cast<Eigen::Index>(i)));
  return Eigen::Map<const Eigen::VectorXd>(kept.data(), static_cast<Eigen::Index>(kept.size()));
}

/// What one road says at one state.
struct Said {
  MechanismAnswer answer;
  std::string failure;
};

/// Roads that some quantity is asked of, pair by pair.
class Pairs {
 public:
  Pairs(Asked quantity, const scene::Mechanism& mechanism, const std::vector<NamedRoad>& roads,
        const Options& options)
      : quantity_(quantity), mechanism_(mechanism) {
    for (std::size_t a = 0; a < roads.size(); ++a)
      for (std::size_t b = a + 1; b < roads.size(); ++b) {
        CheckResult check;
        check.kind = CheckKind::kSame;
        check.quantity = name(quantity);
        check.left = roads[a].name;
        check.right = roads[b].name;
        check.statement = fmt::format("{} by {} = by {}", words(quantity), check.left, check.right);
        check.seed = options.seed;
        pairs_.push_back({a, b, Tally(check), false, (*roads[b].road)->whyLeftOut(quantity)});
      }
  }

  void add(const ClosedState& at, const std::vector<Said>& said) {
    const int index = at.state.index;
    for (Pair& pair : pairs_) {
      if (!at.failure.empty()) {
        pair.tally.fail(index, at.failure);
        pair.is_asked = true;
        continue;
      }
      const Said &left = said[pair.a], &right = said[pair.b];
      const Said& failed = left.failure.empty() ? right : left;
      if (!failed.failure.empty()) {
        pair.tally.fail(index, failed.failure);
        pair.is_asked = true;
        continue;
      }
      const auto &x = left.answer[quantity_], &y = right.answer[quantity_];
      if (quantity_ == Asked::kLambda && at.state.is_redundant) {
        pair.tally.fail(
            index, "",
            fmt::format("{} equations stand for all closures, and lambda is not unique; "
                        "J' lambda is, and is compared",
                        at.state.rows.size()));
        pair.is_asked = true;
        continue;
      }
      if (x.value.size() == 0 || y.value.size() == 0) continue;
      pair.is_asked = true;
      if (quantity_ != Asked::kReactions) {
        pair.tally.add(index, x.value, y.value, x.bound + y.bound);
        continue;
      }
      const std::vector<char>& determined = at.state.determined;
      const Eigen::VectorXd left_of = determinedOf(x.value, determined);
      if (left_of.size() < x.value.size()) {
        // what is open at one state is not always compared
        if (pair.determined.empty()) pair.determined = determined;
        for (std::size_t i = 0; i < determined.size(); ++i)
          if (!determined[i]) pair.determined[i] = 0;
      }
      if (left_of.size() == 0)
        pair.tally.fail(index, "", openWords(determined));
      else
        pair.tally.add(index, left_of, determinedOf(y.value, determined),
                       determinedOf(x.bound + y.bound, determined));
    }
  }

  void addTo(std::vector<CheckResult>& checks) const {
    for (const Pair& pair : pairs_) {
      if (!pair.is_asked && pair.a > 0) continue;  // said once
      checks.push_back(pair.tally.result());
      if (!pair.determined.empty())
        checks.back().statement += " (" + openWords(pair.determined) + ")";
      if (pair.is_asked) continue;
      CheckResult& untold = checks.back();
      untold.kind = CheckKind::kRefusal;
      untold.left = std::exchange(untold.right, "");
      untold.statement = fmt::format("{} tells {}", untold.left, words(quantity_));
      untold.verdict = Verdict::kNotAnswerable;
      untold.reason = pair.why_not;
    }
  }

 private:
  struct Pair {
    std::size_t a, b;
    Tally tally;
    bool is_asked;
    std::string why_not;                ///< where b leaves it out
    std::vector<char> determined = {};  ///< at every state, by reaction; empty: all are
  };
  std::string openWords(const std::vector<char>& determined) const {
    return fmt::format(
        "redundant closures leave {} open, and those that they leave determined are compared",
        openReactions(mechanism_, determined));
  }
  Asked quantity_;
  const scene::Mechanism& mechanism_;
  std::vector<Pair> pairs_;
};

/// Each road against the certified truth.
class Truths {
 public:
  Truths(Asked quantity, const std::vector<NamedRoad>& roads, const Options& options)
      : quantity_(quantity) {
    for (const NamedRoad& road : roads) {
      CheckResult check;
      check.kind = CheckKind::kTruth;
      check.quantity = name(quantity);
      check.left = road.name;
      check.statement = fmt::format("{} by {} = certified truth", words(quantity), road.name);
      check.seed = options.seed;
      tallies_.push_back({Tally(check), std::nullopt});
    }
  }

  void add(const ClosedState& at, const std::vector<Said>& said, const Said& truth) {
    if (!at.failure.empty()) return;  // the pairs have it
    const auto& exact = truth.answer[quantity_];
    for (std::size_t i = 0; i < said.size(); ++i) {
      const std::string& failure = truth.failure.empty() ? said[i].failure : truth.failure;
      if (!failure.empty()) {
        tallies_[i].tally.fail(at.state.index, failure);
        continue;
      }
      const auto& x = said[i].answer[quantity_];
      if (x.value.size() == 0 || exact.value.size() == 0) continue;  // the pairs say why
      const auto kept = [&](const Eigen::VectorXd& all) {
        return quantity_ == Asked::kReactions ? determinedOf(all, at.state.determined) : all;
      };
      const Eigen::VectorXd value = kept(x.value), truth_value = kept(exact.value);
      if (value.size() == 0) continue;
      tallies_[i].tally.add(at.state.index, value, truth_value, kept(x.bound + exact.bound));
      const double size = truth_value.cwiseAbs().maxCoeff();
      if (!(size > 0)) continue;
      const double off = (value - truth_value).cwiseAbs().maxCoeff() / size,
                   digits = off > 0 ? -std::log10(off) : std::numeric_limits<double>::max_digits10;
      std::optional<double>& fewest = tallies_[i].digits;
      fewest = std::min(fewest.value_or(std::numeric_limits<double>::max_digits10), digits);
    }
  }

  void addTo(std::vector<CheckResult>& checks) const {
    for (const One& one : tallies_) {
      CheckResult check = one.tally.result();
      if (check.states == 0) continue;
      check.digits = one.digits;
      checks.push_back(check);
    }
  }

 private:
  struct One {
    Tally tally;
    std::optional<double> digits;
  };
  Asked quantity_;
  std::vector<One> tallies_;
};

/// Stands where there is nobody to compare with.
CheckResult alone(const Options& options) {
  CheckResult check;
  check.law = "mechanism roads";
  check.quantity = name(Asked::kQdd);
  check.statement = "qdd of the whole mechanism by two roads";
  check.seed = options.seed;
  check.states = 1;
  check.addVoided(0, "fewer than two roads hold the whole mechanism", false);
  check.verdict = Verdict::kNotAnswerable;
  check.reason = check.voided_reason;
  return check;
}

/// kMechanismStates, and fewer of a large mechanism.
int statesOf(const scene::Mechanism& mechanism, const Options& options) {
  constexpr int kAllStates = 40, kFewestStates = 2;
  int states = kMechanismStates;
  if (const int n = mechanism.dof(); n > kAllStates) {
    const double share = static_cast<double>(kAllStates) / n;
    states = std::max(kFewestStates, static_cast<int>(states * share * share * share));
  }
  return std::min(options.states, states);
}

Said ask(MechanismRoad& road, const MechanismState& state) {
  Said said;
  try {
    said.answer = road.answer(state);
  } catch (const std::exception& error) {
    said.failure = fmt::format("{}: {}", road.name(), error.what());
  }
  return said;
}

}  // namespace

std::vector<CheckResult> compareRoads(const PreparedScene& scene,
                                      const std::vector<NamedRoad>& roads, const Options& options) {
  std::vector<CheckResult> checks;
  std::vector<NamedRoad> standing;
  for (const NamedRoad& road : roads) {
    if (!road.road.isRefused()) {
      standing.push_back(road);
      continue;
    }
    CheckResult refusal;
    refusal.kind = CheckKind::kRefusal;
    refusal.statement = road.name + " can hold the whole mechanism";
    refusal.left = road.name;
    refusal.seed = options.seed;
    refusal.verdict = Verdict::kNotAnswerable;
    refusal.reason = road.road.refusal();
    checks.push_back(refusal);
  }
  if (standing.size() < 2) {
    checks.push_back(alone(options));
    return checks;
  }
  std::vector<Pairs> all;
  std::vector<Truths> truths;
  for (const Asked quantity : quantitiesOf(scene.mechanism())) {
    all.emplace_back(quantity, scene.mechanism(), standing, options);
    truths.emplace_back(quantity, standing, options);
  }
  const std::shared_ptr<MechanismRoad> certified = certifiedMechanism(scene);
  std::unique_ptr<ClosedStates> states;
  std::string no_states;
  try {
    states = std::make_unique<ClosedStates>(scene);
  } catch (const std::exception& error) {
    no_states = error.what();
  }
  for (int index = 0; index < statesOf(scene.mechanism(), options); ++index) {
    ClosedState at;
    at.state.index = index;
    at.failure = no_states;
    try {
      if (states) at = states->draw(options.seed, index);
    } catch (const std::exception& error) {
      at.failure = error.what();
    }
    std::vector<Said> said(standing.size());
    if (at.failure.empty())
      for (std::size_t i = 0; i < standing.size(); ++i) said[i] = ask(**standing[i].road, at.state);
    const Said truth = at.failure.empty() ? ask(*certified, at.state) : Said{};
    for (Pairs& pairs : all) pairs.add(at, said);
    for (Truths& one : truths) one.add(at, said, truth);
  }
  for (const Truths& one : truths) one.addTo(checks);
  for (const Pairs& pairs : all) pairs.addTo(checks);
  return checks;
}

std::vector<CheckResult> checkMechanism(const PreparedScene& scene, const Options& options) {
  if (!ConstrainedQuantities::isConstrained(scene.mechanism())) return {};
  return compareRoads(scene, mechanismRoads(scene), options);
}

}  // namespace dynwitness::crosscheck
