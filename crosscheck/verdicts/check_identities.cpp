// SPDX-License-Identifier: GPL-3.0-or-later
// The identities on our own sweeps, each side with its running error bound.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/laws/compiled_identities.hpp"
#include "crosscheck/laws/identities_in_balls.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/verdicts/check_identities.hpp"
#include "crosscheck/verdicts/identity_tallies.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "recursive/factorization.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

Eigen::MatrixXd values(const MatrixX<RunningError>& m) {
  return m.unaryExpr([](const RunningError& x) { return x.value(); });
}
Eigen::MatrixXd bounds(const MatrixX<RunningError>& m) {
  return m.unaryExpr([](const RunningError& x) { return x.bound(); });
}

/// M = L D L' has positive pivots: each larger than its own error bound, so proven. Where a pivot
/// is zero within its bound (bounds grow with every elimination), balls decide; one that is proven
/// negative disagrees.
class PositiveDefinite {
 public:
  PositiveDefinite(const PreparedScene& scene, std::uint64_t seed)
      : scene_(scene),
        model_(scene_.model<RunningError>()),
        ws_(model_),
        in_balls_(scene_.mechanism()) {
    result_.law = "positive definite mass matrix";
    result_.statement = "M = L D L' with every pivot D[i] > 0: bound of D[i] < D[i]";
    result_.quantity = "M";
    result_.left = "composite_body";
    result_.unit = Unit::kBoundPerPivot;
    result_.limit = 1;
    result_.seed = seed;
  }

  /// @param is_singular  asked where a pivot cannot be told from zero
  template <typename IsSingular>
  void add(int state, const scene::State<double>& at,
           const std::vector<scene::JointPosition<RunningError>>& x,
           const IsSingular& is_singular) {
    MatrixX<RunningError> M(model_.dof(), model_.dof());
    recursive::massMatrix(model_, x, ws_, M);
    recursive::factorize(M);
    ++result_.states;
    for (int i = 0; i < model_.dof(); ++i) {
      const RunningError& D = M(i, i);
      const std::string entry = "D[" + std::to_string(i + 1) + "]";
      if (!(std::abs(D.value()) > D.bound())) {
        if (const double share = in_balls_(at); share < 1) {
          if (result_.worst_entry.empty()) {
            result_.ratio = result_.worst = share;
            result_.worst_state = state;
            result_.worst_entry = entry;
          }
          return;
        }
        const std::string why = is_singular(state);
        result_.addVoided(
            state,
            why.empty() ? fmt::format("{} is zero within its rounding at state {}", entry, state)
                        : why,
            !why.empty());
        return;  // the pivots after it were divided by it
      }
      const double share =
          D.value() > 0 ? D.bound() / D.value() : std::numeric_limits<double>::infinity();
      if (!result_.worst_entry.empty() && share <= result_.ratio) continue;
      result_.ratio = result_.worst = share;
      result_.worst_state = state;
      result_.worst_entry = entry;
      if (D.value() < 0) {
        result_.verdict = Verdict::kDisagree;
        result_.reason = entry + " is negative at state " + std::to_string(state);
      }
    }
  }
  CheckResult result() const {
    CheckResult out = result_;
    if (out.verdict == Verdict::kAgree && out.judged() == 0) {
      out.verdict = Verdict::kNotAnswerable;
      out.reason = out.voided_reason;
    }
    return out;
  }

 private:
  PreparedScene scene_;
  const recursive::Model<RunningError>& model_;  ///< of scene_
  recursive::Workspace<RunningError> ws_;
  PositivePivots in_balls_;
  CheckResult result_;
};

/// States at which a law is asked in balls: its two sides are then known to 25 digits, and one
/// state says more than a hundred would within a wide limit.
constexpr int kBallStates = 2;

bool isTooWide(const CheckResult& check) {
  return check.limitOverSeen().value_or(0) > kWidestLimit || check.voided > check.excused;
}

/// Laws whose rounding bounds in double would let too much pass, or have none, once more in balls.
void askInBalls(const scene::Scene& scene, const Options& options, std::vector<CheckResult>& laws) {
  if (std::none_of(laws.begin(), laws.end(), isTooWide)) return;
  std::vector<CheckResult> words = inWords(Identities::words(scene.mechanism));
  std::vector<Tally> tallies;
  for (CheckResult& law : words) {
    law.statement +=
        " (in balls: of a mechanism of this size, bounds in double would pass too much)";
    law.seed = options.seed;
    tallies.emplace_back(law);
  }
  IdentitiesInBalls identities(scene.mechanism);
  for (int k = 0; k < std::min(options.states, kBallStates); ++k) {
    const std::vector<TwoSides<Ball>> sides =
        identities(drawState(scene.mechanism, scene.name, options.seed, k));
    for (std::size_t i = 0; i < sides.size(); ++i) addBalls(tallies[i], k, sides[i]);
  }
  for (std::size_t i = 0; i < laws.size(); ++i)
    if (isTooWide(laws[i])) laws[i] = tallies[i].result();
}

}  // namespace

double largestOf(const MatrixX<Ball>& m) {
  double largest = 0;
  for (const Ball& x : m.reshaped()) largest = std::max(largest, x.atMost());
  return largest;
}

std::optional<double> digitsLeft(const MatrixX<Ball>& distance, const MatrixX<Ball>& of) {
  constexpr double kMost = std::numeric_limits<double>::max_digits10;
  const double farthest = largestOf(distance), largest = largestOf(of);
  if (!std::isfinite(farthest) || !(largest > 0)) return std::nullopt;
  return farthest > 0 ? std::clamp(-std::log10(farthest / largest), 0.0, kMost) : kMost;
}

void addBalls(Tally& tally, int state, const TwoSides<Ball>& sides, const std::string& excuse) {
  if (!sides.failure.empty()) return tally.fail(state, sides.failure, sides.failure);
  const double largest = std::max(largestOf(sides.left), largestOf(sides.right));
  // a difference contains 0 when its midpoint is within its radius
  const MatrixX<Ball> difference = sides.left - sides.right;
  tally.addDifference(state, difference.unaryExpr([](const Ball& x) { return x.mid(); }),
                      difference.unaryExpr([](const Ball& x) { return x.radius(); }), largest,
                      excuse);
}

IdentityTallies::IdentityTallies(const std::vector<LawWords>& laws, std::uint64_t seed) {
  for (CheckResult& check : inWords(laws)) {
    check.seed = seed;
    tallies_.emplace_back(check);
  }
}

void IdentityTallies::add(int state, const std::vector<TwoSides<RunningError>>& sides,
                          const std::function<std::string(int)>& is_singular) {
  for (std::size_t i = 0; i < tallies_.size(); ++i) {
    const TwoSides<RunningError>& law = sides[i];
    if (!law.failure.empty()) {  // the mechanism has no such law
      tallies_[i].fail(state, law.failure, law.failure);
      continue;
    }
    const Eigen::MatrixXd limit = bounds(law.left) + bounds(law.right);
    tallies_[i].add(state, values(law.left), values(law.right), limit,
                    limit.allFinite() ? std::string() : is_singular(state));
  }
}

std::vector<CheckResult> IdentityTallies::results() const {
  std::vector<CheckResult> results;
  for (const Tally& tally : tallies_) results.push_back(tally.result());
  return results;
}

std::vector<CheckResult> checkIdentities(const PreparedScene& prepared, const Options& options) {
  const scene::Scene& scene = prepared.scene();
  IdentityTallies tallies(Identities::words(scene.mechanism), options.seed);
  SweptMechanism<RunningError> swept(scene.mechanism, RunningErrorNumbers(scene.mechanism),
                                     prepared.model<RunningError>(),
                                     prepared.modelWithFixedJoints<RunningError>());
  PositiveDefinite positive(prepared, options.seed);
  // the truth is asked where something divides by what may be zero, which is rare
  std::optional<Truth> truth;
  std::map<int, std::string> known;
  const auto isSingular = [&](int k) -> std::string {
    const auto [it, is_new] = known.try_emplace(k);
    if (!is_new) return it->second;
    if (!truth) truth.emplace(scene.mechanism);
    const Certified qdd =
        (*truth)(Quantity::kQdd, drawState(scene.mechanism, scene.name, options.seed, k));
    return it->second = qdd.is_impossible ? qdd.reason : std::string();
  };
  scene::Work work("laws of mechanics", options.states);
  for (int k = 0; k < options.states; ++k, work.done()) {
    const scene::State<double> drawn = drawState(scene.mechanism, scene.name, options.seed, k);
    const scene::State<RunningError> state = runningErrorState(drawn, scene.mechanism);
    tallies.add(k, Identities::sides(scene.mechanism, swept.at(state)), isSingular);
    positive.add(k, drawn, state.x, isSingular);
  }
  std::vector<CheckResult> laws = tallies.results();
  askInBalls(scene, options, laws);
  std::vector<CheckResult> results = {positive.result()};
  for (CheckResult& check : laws) results.push_back(std::move(check));
  return results;
}

}  // namespace dynwitness::crosscheck
