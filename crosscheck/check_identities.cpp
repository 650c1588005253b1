// SPDX-License-Identifier: GPL-3.0-or-later
// The identities on our own sweeps, each side with its running error bound.
#include "crosscheck/arithmetic/running_error.hpp"
#include "crosscheck/crosscheck.hpp"
#include "crosscheck/identities.hpp"
#include "crosscheck/states.hpp"
#include "crosscheck/tally.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::crosscheck {
namespace {

Eigen::MatrixXd values(const MatrixOf<RunningError>& m) {
  return m.unaryExpr([](const RunningError& x) { return x.value(); });
}
Eigen::MatrixXd bounds(const MatrixOf<RunningError>& m) {
  return m.unaryExpr([](const RunningError& x) { return x.bound(); });
}

/// M = L D L' has positive pivots: each larger than its own error bound, so proven. A pivot that is
/// zero within its bound proves nothing; one that is proven negative disagrees.
class PositiveDefinite {
 public:
  PositiveDefinite(const scene::Mechanism& mechanism, std::uint64_t seed)
      : model_(recursive::buildModel(mechanism, RunningErrorNumbers(mechanism))), ws_(model_) {
    result_.check = "positive definite mass matrix";
    result_.statement = "M = L D L' with every pivot D[i] > 0: bound of D[i] < D[i]";
    result_.quantity = "M";
    result_.left = "composite_body";
    result_.unit = "error bound / pivot";
    result_.limit = 1;
    result_.seed = seed;
  }

  void add(int state, const std::vector<scene::JointPosition<RunningError>>& x) {
    MatrixOf<RunningError> M(model_.dof(), model_.dof());
    recursive::massMatrix(model_, x, ws_, M);
    recursive::factorize(M);
    ++result_.states;
    for (int i = 0; i < model_.dof(); ++i) {
      const RunningError& D = M(i, i);
      const std::string entry = "D[" + std::to_string(i + 1) + "]";
      if (!(std::abs(D.value()) > D.bound())) {
        unanswered_ = entry + " is zero within its rounding at state " + std::to_string(state) +
                      ": M is singular there, a joint moves no inertia";
        return;  // the pivots after it were divided by it
      }
      const double share = D.value() > 0 ? D.bound() / D.value()
                                         : std::numeric_limits<double>::infinity();
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
    if (out.verdict == Verdict::kAgree && !unanswered_.empty()) {
      out.verdict = Verdict::kNotAnswerable;
      out.reason = unanswered_;
    }
    return out;
  }

 private:
  recursive::Model<RunningError> model_;
  recursive::Workspace<RunningError> ws_;
  CheckResult result_;
  std::string unanswered_;
};

}  // namespace

std::vector<CheckResult> checkIdentities(const scene::Scene& scene, const Options& options) {
  std::vector<Tally> tallies;
  for (CheckResult& check : inWords(kIdentities)) {
    check.seed = options.seed;
    tallies.emplace_back(check);
  }
  Identities<RunningErrorNumbers> identities(scene.mechanism, RunningErrorNumbers(scene.mechanism));
  PositiveDefinite positive(scene.mechanism, options.seed);
  for (int k = 0; k < options.states; ++k) {
    const scene::State<RunningError> state =
        runningErrorState(drawState(scene.mechanism, scene.name, options.seed, k));
    const std::vector<TwoSides<RunningError>> sides = identities.evaluate(state);
    for (int i = 0; i < kIdentityCount; ++i) {
      if (!sides[i].failure.empty()) {
        tallies[i].fail(k, sides[i].failure);
        continue;
      }
      tallies[i].add(k, values(sides[i].left), values(sides[i].right),
                     bounds(sides[i].left) + bounds(sides[i].right));
    }
    positive.add(k, state.x);
  }
  std::vector<CheckResult> results = {positive.result()};
  for (const Tally& tally : tallies) results.push_back(tally.result());
  return results;
}

}  // namespace dynwitness::crosscheck
