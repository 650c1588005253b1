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
#include "crosscheck/verdicts/within_bounds.hpp"
#include "crosscheck/witnesses/sharp_bounds.hpp"
#include "crosscheck/witnesses/textbook_derivatives.hpp"
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

/// What one road answers in double at a state.
struct InDouble {
  std::map<Derivative, Eigen::MatrixXd> value;
  std::map<Derivative, Eigen::MatrixXd> bound;  ///< of those of tau, entry by entry
  /// Of those of qdd: how far M times the answer along u may be from what is solved for.
  std::map<Derivative, Eigen::VectorXd> residual;
};

template <typename Matrix>
MatrixX<AdjointError> along(const Matrix& m, const std::vector<double>& u) {
  MatrixX<AdjointError> out = MatrixX<AdjointError>::Constant(m.rows(), 1, AdjointError(0));
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j)
      out(i, 0) += m(i, j) * AdjointError(u[static_cast<std::size_t>(j)]);
  return out;
}

Eigen::MatrixXd boundsOf(const MatrixX<RunningError>& m) {
  return m.unaryExpr([](const RunningError& x) { return x.bound(); });
}

/** Answers in double, and how far rounding may have taken them: by running errors, and where M is
    solved with, by what each rounding does to the residual.
    @tparam Double   answers ofForces() and ofAccelerations() in double
    @tparam Sweeps   the same function on any scalar */
template <typename Double, template <typename> class Sweeps>
class RoadInDouble {
 public:
  explicit RoadInDouble(const PreparedScene& scene)
      : in_double_(scene.model<double>()),
        bounded_(scene.model<RunningError>()),
        weighed_([mechanism = scene.mechanism()] {
          return std::make_unique<Sweeps<AdjointError>>(
              recursive::buildModel(mechanism, AdjointErrorNumbers(mechanism)));
        }) {}
  /// @param is_regular  M can be solved with
  InDouble operator()(const scene::State<double>& state, const scene::State<RunningError>& bounded,
                      bool is_regular) {
    InDouble out;
    const auto of_tau = in_double_.ofForces(state);
    const auto limits = bounded_.ofForces(bounded);
    put(out.value, 0, of_tau);
    out.bound = {{Derivative::kTauByQ, boundsOf(limits.by_q)},
                 {Derivative::kTauByQd, boundsOf(limits.by_qd)},
                 {Derivative::kTauByQdd, boundsOf(limits.by_last)}};
    if (!is_regular) return out;
    put(out.value, 3, in_double_.ofAccelerations(state));
    const auto residual = [&](auto matrix) {
      return weighed_.residual(of_tau.by_last, [&](Sweeps<AdjointError>& sweeps) {
        return along(sweeps.ofAccelerations(adjointState(bounded)).*matrix, state.tau);
      });
    };
    using Matrices = typename Sweeps<AdjointError>::Matrices;
    out.residual = {{Derivative::kQddByQ, residual(&Matrices::by_q)},
                    {Derivative::kQddByQd, residual(&Matrices::by_qd)},
                    {Derivative::kQddByTau, residual(&Matrices::by_last)}};
    return out;
  }

 private:
  template <typename Matrices>
  static void put(std::map<Derivative, Eigen::MatrixXd>& out, int first, const Matrices& m) {
    int k = first;
    for (const auto* matrix : {&m.by_q, &m.by_qd, &m.by_last})
      out[kDerivatives[static_cast<std::size_t>(k++)]] = *matrix;
  }

  Double in_double_;
  Sweeps<RunningError> bounded_;
  SharpBounds<Sweeps<AdjointError>> weighed_;
};

/// The fast sweeps as they are called: in the vectors of this processor.
class FastInDouble {
 public:
  using Matrices = FastDerivatives<double>::Matrices;
  explicit FastInDouble(const recursive::Model<double>& model) : plan_(model), room_(plan_) {}
  Matrices ofForces(const scene::State<double>& s) {
    auto out = room();
    const std::size_t n = static_cast<std::size_t>(plan_.dof);
    recursive::fast::inverseDynamicsDerivatives<double>(
        plan_, s.x.data(), s.qd.data(), s.qdd.data(), room_.of_tau,
        {out.by_q.data(), out.by_qd.data(), n, out.by_last.data(), n});
    return out;
  }
  Matrices ofAccelerations(const scene::State<double>& s) {
    auto out = room();
    recursive::fast::forwardDynamicsDerivatives<double>(
        plan_, s.x.data(), s.qd.data(), s.qdd.data(), room_,
        {out.by_q.data(), out.by_qd.data(), out.by_last.data()});
    return out;
  }

 private:
  Matrices room() const {
    const recursive::RowsX<double> empty = recursive::RowsX<double>::Zero(plan_.dof, plan_.dof);
    return {empty, empty, empty};
  }
  recursive::fast::Plan<double> plan_;
  recursive::fast::AccelerationDerivativesWorkspace<double> room_;
};

/// What one road answers in double of one quantity, against the truth.
class AgainstTruth {
 public:
  AgainstTruth(Derivative quantity, DerivativeRoad road, std::uint64_t seed)
      : quantity_(quantity), tally_(described(quantity, road, seed)) {}

  /// @param u         the direction
  /// @param singular  why qdd has no derivatives here; empty: it has
  void add(int state, const InDouble& said, const std::map<Derivative, MatrixX<Ball>>& truth,
           const std::vector<double>& u, const std::string& singular) {
    if (!isOfForces(quantity_) && !singular.empty()) return tally_.fail(state, singular, singular);
    const BallPrecision precision(kFirstBits);
    const MatrixX<Ball>& right = truth.at(quantity_);
    const MatrixX<Ball> value = exactly(said.value.at(quantity_));
    countDigits(value - right, right);
    if (isOfForces(quantity_)) return put(state, value - right, said.bound.at(quantity_), right);
    // M X u = -(dtau/dq) u, M X u = u
    const MatrixX<Ball> direction = exactly(column(u));
    MatrixX<Ball> solved_for = direction;
    if (quantity_ == Derivative::kQddByQ) solved_for = -(truth.at(Derivative::kTauByQ) * direction);
    if (quantity_ == Derivative::kQddByQd)
      solved_for = -(truth.at(Derivative::kTauByQd) * direction);
    const MatrixX<Ball> made = value * direction;
    put(state, truth.at(Derivative::kTauByQdd) * made - solved_for, said.residual.at(quantity_),
        solved_for);
  }
  CheckResult result() const {
    CheckResult out = tally_.result();
    out.digits = digits_;
    return out;
  }

 private:
  static MatrixX<Ball> exactly(const Eigen::MatrixXd& m) {
    return m.unaryExpr([](double x) { return Ball(x); });
  }
  static CheckResult described(Derivative quantity, DerivativeRoad road, std::uint64_t seed) {
    CheckResult check;
    check.kind = CheckKind::kTruth;
    check.quantity = name(quantity);
    check.left = name(road);
    check.statement =
        isOfForces(quantity)
            ? fmt::format("|{} by {} - truth| <= its error bound", check.quantity, check.left)
            : fmt::format("|M {} u - {}| <= what solving may leave, {} by {}", check.quantity,
                          quantity == Derivative::kQddByTau ? "u"
                          : quantity == Derivative::kQddByQ ? "(-dtau_dq u)"
                                                            : "(-dtau_dqd u)",
                          check.quantity, check.left);
    check.seed = seed;
    return check;
  }
  void put(int state, const MatrixX<Ball>& difference, const Eigen::MatrixXd& limit,
           const MatrixX<Ball>& of) {
    tally_.addDifference(state, difference.unaryExpr([](const Ball& x) { return x.mid(); }), limit,
                         largestOf(of));
  }
  void countDigits(const MatrixX<Ball>& distance, const MatrixX<Ball>& of) {
    const std::optional<double> digits = digitsLeft(distance, of);
    if (digits) digits_ = std::min(digits_.value_or(*digits), *digits);
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
  return sameInWords(name(pair.quantity), name(pair.left), name(pair.right));
}

std::vector<CheckResult> checkDerivatives(const PreparedScene& prepared, const Options& options,
                                          const PreparedScene* answering) {
  const PreparedScene& in_double = answering == nullptr ? prepared : *answering;
  const scene::Scene& scene = prepared.scene();
  const scene::Mechanism& mechanism = scene.mechanism;
  RoadsInBalls in_balls(mechanism);
  std::vector<Tally> pairs;
  for (const DerivativePair& pair : in_balls.pairs()) {
    CheckResult check = inWords(pair);
    check.seed = options.seed;
    pairs.emplace_back(check);
  }
  RoadInDouble<TextbookDerivatives<double>, TextbookDerivatives> textbook(in_double);
  std::optional<RoadInDouble<FastInDouble, FastDerivatives>> fast;
  std::vector<AgainstTruth> of_textbook, of_fast;
  for (const Derivative quantity : kDerivatives)
    of_textbook.emplace_back(quantity, DerivativeRoad::kTextbook, options.seed);
  if (whyNoFastDerivatives(mechanism).empty()) {
    fast.emplace(in_double);
    for (const Derivative quantity : kDerivatives)
      of_fast.emplace_back(quantity, DerivativeRoad::kFast, options.seed);
  }
  const int states = std::min(options.states, kStates);
  Truth truth(mechanism);
  scene::Work work("derivatives", states);
  for (int k = 0; k < states; ++k, work.done()) {
    const scene::State<double> state = drawState(mechanism, scene.name, options.seed, k);
    const InBalls said = in_balls(state);
    // where M is singular, qdd has no derivatives
    const Certified qdd = truth(Quantity::kQdd, state);
    const std::string singular = qdd.is_impossible ? qdd.reason : std::string();
    for (std::size_t i = 0; i < pairs.size(); ++i) addBalls(pairs[i], k, said.sides[i], singular);
    const scene::State<RunningError> bounded = runningErrorState(state, mechanism);
    const auto judge = [&](std::vector<AgainstTruth>& checks, auto& road) {
      const InDouble answers = road(state, bounded, singular.empty());
      for (AgainstTruth& check : checks) check.add(k, answers, said.truth, state.tau, singular);
    };
    judge(of_textbook, textbook);
    if (fast) judge(of_fast, *fast);
  }
  std::vector<CheckResult> results;
  for (const Tally& tally : pairs) results.push_back(tally.result());
  for (const std::vector<AgainstTruth>* of : {&of_textbook, &of_fast})
    for (const AgainstTruth& check : *of) results.push_back(check.result());
  for (CheckResult& check : withoutFast(mechanism, options.seed))
    results.push_back(std::move(check));
  return results;
}

}  // namespace dynwitness::crosscheck
