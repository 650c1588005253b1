// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/check_derivatives.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/laws/narrow_sides.hpp"
#include "crosscheck/verdicts/identity_tallies.hpp"
#include "crosscheck/verdicts/truth.hpp"
#include "recursive/fast/derivatives.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

/// In balls two sides are known to 25 digits, and one state says more than a hundred would within
/// limits of double precision.
constexpr int kStates = 2;

/// All pairs at a state of doubles taken as the numbers that they are, and the truth there.
struct InBalls {
  std::vector<TwoSides<Ball>> sides;
  std::map<Derivative, MatrixX<Ball>> truth;
};

/// The precision is doubled until all is narrow.
class RoadsInBalls {
 public:
  explicit RoadsInBalls(const scene::Mechanism& mechanism)
      : mechanism_(mechanism), programs_(mechanism, true), pairs_(derivativePairs(mechanism)) {}

  const std::vector<DerivativePair>& pairs() const { return pairs_; }
  InBalls operator()(const scene::State<double>& state) {
    for (;; bits_ *= 2) {
      const BallPrecision precision(bits_);
      auto& roads = roads_[bits_];
      if (!roads)
        roads =
            std::make_unique<DerivativeRoads<Ball>>(mechanism_, programs_, BallNumbers(mechanism_));
      roads->at(ballState(state, mechanism_));
      InBalls out;
      for (const DerivativePair& pair : pairs_) out.sides.push_back(roads->sides(pair));
      for (const Derivative quantity : kDerivatives)
        out.truth.emplace(quantity, roads->whole(quantity));
      if (2 * bits_ > kMostBits || std::all_of(out.sides.begin(), out.sides.end(), isNarrow))
        return out;
    }
  }

 private:
  scene::Mechanism mechanism_;
  LagrangeDerivatives programs_;
  std::vector<DerivativePair> pairs_;
  std::map<long, std::unique_ptr<DerivativeRoads<Ball>>> roads_;  ///< by precision
  long bits_ = kFirstBits;                                        ///< that were enough so far
};

/// Six matrices in double, and how far rounding may have taken them.
using Bounded = std::map<Derivative, Answer>;

/// By the textbook's sweeps; the same in double and with bounds.
class TextbookInDouble {
 public:
  explicit TextbookInDouble(const PreparedScene& scene)
      : model_(scene.model<RunningError>()), room_(model_), of_tau_(model_), of_qdd_(model_) {}
  Bounded operator()(const scene::State<RunningError>& state) {
    recursive::inverseDynamicsDerivatives(model_, state.x, state.qd, state.qdd, room_, of_tau_);
    Bounded out;
    put(out, Derivative::kTauByQ, of_tau_.dtau_dq);
    put(out, Derivative::kTauByQd, of_tau_.dtau_dqd);
    put(out, Derivative::kTauByQdd, of_tau_.M);
    recursive::solveForAccelerations(model_, room_, of_tau_, of_qdd_);
    put(out, Derivative::kQddByQ, of_qdd_.dqdd_dq);
    put(out, Derivative::kQddByQd, of_qdd_.dqdd_dqd);
    put(out, Derivative::kQddByTau, of_qdd_.dqdd_dtau);
    return out;
  }

 private:
  template <typename Matrix>
  static void put(Bounded& out, Derivative quantity, const Matrix& m) {
    out[quantity] = {m.unaryExpr([](const RunningError& x) { return x.value(); }),
                     m.unaryExpr([](const RunningError& x) { return x.bound(); })};
  }

  const recursive::Model<RunningError>& model_;
  recursive::DerivativesWorkspace<RunningError> room_;
  recursive::InverseDynamicsDerivatives<RunningError> of_tau_;
  recursive::ForwardDynamicsDerivatives<RunningError> of_qdd_;
};

/// By the fast sweeps as they are called: in double, in the vectors of this processor.
class FastInDouble {
 public:
  explicit FastInDouble(const PreparedScene& scene)
      : plan_(scene.model<double>()), room_(plan_), bounded_(scene.model<RunningError>()) {}
  Bounded operator()(const scene::State<double>& state,
                     const scene::State<RunningError>& with_bounds) {
    namespace fast = recursive::fast;
    const std::size_t n = plan_.dof;
    Rows m[6];
    for (Rows& matrix : m) matrix.resize(plan_.dof, plan_.dof);
    fast::inverseDynamicsDerivatives<double>(plan_, state.x.data(), state.qd.data(),
                                             state.qdd.data(), room_.of_tau,
                                             {m[0].data(), m[1].data(), n, m[2].data(), n});
    fast::forwardDynamicsDerivatives<double>(plan_, state.x.data(), state.qd.data(),
                                             state.qdd.data(), room_,
                                             {m[3].data(), m[4].data(), m[5].data()});
    const auto of_tau = bounded_.ofForces(with_bounds),
               of_qdd = bounded_.ofAccelerations(with_bounds);
    const recursive::RowsX<RunningError>* const bounds[] = {
        &of_tau.by_q, &of_tau.by_qd, &of_tau.by_last, &of_qdd.by_q, &of_qdd.by_qd, &of_qdd.by_last};
    Bounded out;
    for (int k = 0; k < 6; ++k) out[kDerivatives[k]] = boundedAnswer(m[k], *bounds[k]);
    return out;
  }

 private:
  using Rows = recursive::RowsX<double>;
  recursive::fast::Plan<double> plan_;
  recursive::fast::AccelerationDerivativesWorkspace<double> room_;
  FastDerivatives<RunningError> bounded_;
};

/// What one road answers in double of one quantity, against the truth.
class AgainstTruth {
 public:
  AgainstTruth(Derivative quantity, const char* road, std::uint64_t seed)
      : quantity_(quantity), tally_(described(quantity, road, seed)) {}

  void add(int state, const Answer& answer, const MatrixX<Ball>& truth, const std::string& excuse) {
    const BallPrecision precision(kFirstBits);
    const MatrixX<Ball> distance = answer.value.unaryExpr([](double x) { return Ball(x); }) - truth;
    double largest = 0, farthest = 0;
    for (const Ball& x : truth.reshaped()) largest = std::max(largest, x.atMost());
    for (const Ball& x : distance.reshaped()) farthest = std::max(farthest, x.atMost());
    tally_.addDifference(state, distance.unaryExpr([](const Ball& x) { return x.mid(); }),
                         answer.bound, largest, excuse);
    if (!std::isfinite(farthest) || !(largest > 0)) return;
    constexpr double kMost = std::numeric_limits<double>::max_digits10;
    const double digits =
        farthest > 0 ? std::clamp(-std::log10(farthest / largest), 0.0, kMost) : kMost;
    digits_ = std::min(digits_.value_or(kMost), digits);
  }
  CheckResult result() const {
    CheckResult out = tally_.result();
    out.digits = digits_;
    return out;
  }
  Derivative quantity() const { return quantity_; }

 private:
  static CheckResult described(Derivative quantity, const char* road, std::uint64_t seed) {
    CheckResult check;
    check.kind = CheckKind::kTruth;
    check.quantity = name(quantity);
    check.left = road;
    check.statement =
        fmt::format("|{} by {} - truth| <= its error bound", check.quantity, check.left);
    check.seed = seed;
    return check;
  }

  Derivative quantity_;
  Tally tally_;
  std::optional<double> digits_;
};

/// One a quantity for whom the fast road is closed.
std::vector<CheckResult> withoutFast(const scene::Mechanism& mechanism, std::uint64_t seed) {
  std::vector<CheckResult> out;
  const std::string reason = whyNoFastDerivatives(mechanism);
  if (reason.empty()) return out;
  for (const Derivative quantity : kDerivatives) {
    CheckResult check;
    check.kind = CheckKind::kWitness;
    check.quantity = name(quantity);
    check.left = name(DerivativeRoad::kFast);
    check.statement = fmt::format("{} answers {}", check.left, check.quantity);
    check.seed = seed;
    check.verdict = Verdict::kNotAnswerable;
    check.reason = reason;
    out.push_back(std::move(check));
  }
  return out;
}

}  // namespace

CheckResult inWords(const DerivativePair& pair) {
  CheckResult check;
  check.kind = CheckKind::kSame;
  check.quantity = name(pair.quantity);
  check.left = name(pair.left);
  check.right = name(pair.right);
  check.statement = fmt::format("{0} by {1} = {0} by {2}", check.quantity, check.left, check.right);
  return check;
}

std::vector<CheckResult> checkDerivatives(const PreparedScene& prepared, const Options& options) {
  const scene::Scene& scene = prepared.scene();
  const scene::Mechanism& mechanism = scene.mechanism;
  RoadsInBalls in_balls(mechanism);
  std::vector<Tally> pairs;
  for (const DerivativePair& pair : in_balls.pairs()) {
    CheckResult check = inWords(pair);
    check.seed = options.seed;
    pairs.emplace_back(check);
  }
  TextbookInDouble textbook(prepared);
  std::optional<FastInDouble> fast;
  if (whyNoFastDerivatives(mechanism).empty()) fast.emplace(prepared);
  std::vector<AgainstTruth> of_textbook, of_fast;
  for (const Derivative quantity : kDerivatives) {
    of_textbook.emplace_back(quantity, name(DerivativeRoad::kTextbook), options.seed);
    of_fast.emplace_back(quantity, name(DerivativeRoad::kFast), options.seed);
  }
  const int states = std::min(options.states, kStates);
  scene::Work work("derivatives", states);
  for (int k = 0; k < states; ++k, work.done()) {
    const scene::State<double> state = drawState(mechanism, scene.name, options.seed, k);
    const InBalls said = in_balls(state);
    // where M is singular, qdd has no derivatives
    const Certified qdd = Truth(mechanism)(Quantity::kQdd, state);
    const std::string singular = qdd.is_impossible ? qdd.reason : std::string();
    for (std::size_t i = 0; i < pairs.size(); ++i) addBalls(pairs[i], k, said.sides[i], singular);
    const scene::State<RunningError> bounded = runningErrorState(state, mechanism);
    const auto judge = [&](std::vector<AgainstTruth>& roads, const Bounded& answers) {
      for (AgainstTruth& road : roads)
        road.add(k, answers.at(road.quantity()), said.truth.at(road.quantity()), singular);
    };
    judge(of_textbook, textbook(bounded));
    if (fast) judge(of_fast, (*fast)(state, bounded));
  }
  std::vector<CheckResult> results;
  for (const Tally& tally : pairs) results.push_back(tally.result());
  for (const AgainstTruth& road : of_textbook) results.push_back(road.result());
  if (!fast) of_fast.clear();
  for (const AgainstTruth& road : of_fast) results.push_back(road.result());
  for (CheckResult& check : withoutFast(mechanism, options.seed))
    results.push_back(std::move(check));
  return results;
}

}  // namespace dynwitness::crosscheck
