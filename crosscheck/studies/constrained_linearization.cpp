// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/constrained_linearization.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/QR>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/motion/closed_motion.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/dual_root.hpp"
#include "crosscheck/scalars/moving_state.hpp"
#include "crosscheck/studies/bounded_balls.hpp"
#include "crosscheck/studies/independent_rates.hpp"
#include "crosscheck/studies/rate_frame.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/dense_equations.hpp"
#include "recursive/hybrid_dynamics.hpp"

namespace dynwitness::crosscheck {
namespace {

using Balls = recursive::MatrixX<Ball>;
using Moving = Dual<Ball>;
using DualOfBalls = DualNumbers<BallNumbers>;

/// What closures leave free at a state, by rates.
struct Freedom {
  Indices rows;        ///< of closures, that stand for all
  Indices positional;  ///< of these, by place, that positions have to fulfil
  Indices dependent_q, dependent_v, q, v;
};

/// The constrained mechanism's answer along a direction.
struct Change {
  VectorX<Ball> qdd, closure_rate, closure;  ///< of qdd, of J qd; J dq
};

struct Derivatives {
  Balls by_position, by_rate, by_force;  ///< of qdd
  Balls rate_by_position, J;             ///< d(J qd)/dq; J of the closures' rows
  Balls J_held;                          ///< of the acceleration constraints
  VectorX<Ball> qdd, tau;                ///< at the state itself; tau with what drives take
};

Balls zeros(std::size_t rows, std::size_t columns) {
  return Balls::Constant(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns),
                         Ball(0));
}

}  // namespace

struct ConstrainedLinearization::Parts {
  explicit Parts(const scene::Scene& of)
      : scene(of),
        mechanism(scene.mechanism),
        motion(scene, 0),
        driven(recursive::drivenRates(mechanism)),
        of_drives(ConstrainedQuantities(scene).start().qdd) {
    for (const scene::Closure& closure : mechanism.closures)
      for (int row = 0; row < scene::equationCount(closure.kind); ++row)
        is_positional.push_back(!scene::isOfRates(closure.kind, row));
  }

  int n() const { return motion.dof(); }
  ClosedMotion::State joined(const std::vector<double>& q, const std::vector<double>& qd) const {
    ClosedMotion::State y = q;
    y.insert(y.end(), qd.begin(), qd.end());
    y.push_back(0);
    return y;
  }
  void apart(const ClosedMotion::State& y, std::vector<double>* q, std::vector<double>* qd) const {
    const auto rates = y.begin() + motion.positions();
    q->assign(y.begin(), rates);
    qd->assign(rates, y.end() - 1);
  }
  Direction<Ball> still() const {
    const std::vector<Ball> zero(static_cast<std::size_t>(n()), Ball(0));
    return {zero, zero, zero, zero};
  }
  scene::State<Ball> stateAt(const std::vector<double>& q, const std::vector<double>& qd) const {
    scene::State<double> state;
    for (const double x : q) state.x.push_back(scene::jointPosition(x));
    state.qd = qd;
    state.qdd = of_drives;
    state.tau.assign(qd.size(), 0.0);
    return ballState(state, mechanism);
  }

  Freedom freedomAt(const std::vector<double>& q, const std::vector<double>& qd);
  template <typename Equations>
  Change change(const Equations& equations, const scene::State<Ball>& state, const Indices& rows,
                const Direction<Ball>& along, Derivatives* value = nullptr) const;
  Derivatives derivatives(const scene::State<Ball>& state, const Indices& rows) const;
  Indices steerable(const Freedom& freedom, const Derivatives& d) const;
  std::vector<Ball> holding(const scene::State<Ball>& state, const Freedom& freedom) const;

  scene::Scene scene;
  const scene::Mechanism& mechanism;
  ClosedMotion motion;
  std::vector<char> driven;
  std::vector<double> of_drives;  ///< accelerations at t = 0, 0 of the others
  std::vector<bool> is_positional;
  // of the last differentiate()
  scene::State<Ball> state;
  Freedom freedom;
  Derivatives last;
};

Freedom ConstrainedLinearization::Parts::freedomAt(const std::vector<double>& q,
                                                   const std::vector<double>& qd) {
  const ClosedMotion::State y = joined(q, qd);
  motion.choose(y, 0);
  Freedom out;
  out.rows = motion.chosen();
  Indices of_rates;
  for (int k = 0; k < static_cast<int>(out.rows.size()); ++k)
    (is_positional[static_cast<std::size_t>(out.rows[static_cast<std::size_t>(k)])] ? out.positional
                                                                                    : of_rates)
        .push_back(k);
  const Indices& free = motion.freeRates();
  const Eigen::MatrixXd J = motion.jacobian()(out.rows, Eigen::all), J_h = J(out.positional, free);
  out.dependent_q = pivots(J_h, free);
  out.q = without(free, out.dependent_q);
  // of equations of rates what the others leave
  Eigen::MatrixXd left = J(of_rates, out.q);
  if (!out.positional.empty())
    left -= J(of_rates, out.dependent_q) *
            solvedByColumns(J(out.positional, out.dependent_q), J(out.positional, out.q));
  const Indices more = pivots(left, out.q);
  std::merge(out.dependent_q.begin(), out.dependent_q.end(), more.begin(), more.end(),
             std::back_inserter(out.dependent_v));
  out.v = without(free, out.dependent_v);
  return out;
}

/// @param equations  of (numbers, state)
/// @param value      what is there already: of the state itself, where it is asked for
template <typename Equations>
Change ConstrainedLinearization::Parts::change(const Equations& equations,
                                               const scene::State<Ball>& at, const Indices& rows,
                                               const Direction<Ball>& along,
                                               Derivatives* value) const {
  const BallNumbers number(mechanism);
  const scene::State<Moving> state_moved =
      moving(recursive::buildModel(mechanism, number), at, along);
  DenseEquations<Moving> e = equations(DualOfBalls(number), state_moved);
  const int held = static_cast<int>(mechanism.acceleration_constraints.size()),
            closures = static_cast<int>(e.J.rows()) - held;
  Indices kept = rows;
  for (int k = 0; k < held; ++k) kept.push_back(closures + k);
  keepRows(kept, e);
  const DenseSolution<Moving> x = solveDense(e, driven, state_moved.tau, state_moved.qdd);
  const auto m = static_cast<Eigen::Index>(rows.size());
  Change out{VectorX<Ball>(n()), VectorX<Ball>(m), VectorX<Ball>(m)};
  for (int i = 0; i < n(); ++i) out.qdd(i) = x.qdd(i).derivative;
  for (Eigen::Index k = 0; k < m; ++k) {
    out.closure_rate(k) = out.closure(k) = Ball(0);
    for (int i = 0; i < n(); ++i) {
      const auto c = static_cast<std::size_t>(i);
      out.closure_rate(k) += (e.J(k, i) * state_moved.qd[c]).derivative;
      out.closure(k) += e.J(k, i).value * along.q[c];
    }
  }
  if (value == nullptr) return out;
  value->J = Balls(m, n());
  value->J_held = Balls(held, n());
  value->qdd = value->tau = VectorX<Ball>(n());
  for (int i = 0; i < n(); ++i) {
    value->qdd(i) = x.qdd(i).value;
    value->tau(i) = x.tau(i).value;
    for (Eigen::Index k = 0; k < m; ++k) value->J(k, i) = e.J(k, i).value;
    for (int k = 0; k < held; ++k) value->J_held(k, i) = e.J(m + k, i).value;
  }
  return out;
}

Derivatives ConstrainedLinearization::Parts::derivatives(const scene::State<Ball>& at,
                                                         const Indices& rows) const {
  const auto swept = [&](const DualOfBalls& number, const scene::State<Moving>& x) {
    return sweptEquations(mechanism, number, x);
  };
  Derivatives out;
  out.by_position = out.by_rate = out.by_force = zeros(n(), n());
  out.rate_by_position = zeros(rows.size(), n());
  for (int j = 0; j < n(); ++j) {
    if (driven[static_cast<std::size_t>(j)]) continue;
    const auto along = [&](std::vector<Ball> Direction<Ball>::*part) {
      Direction<Ball> unit = still();
      (unit.*part)[static_cast<std::size_t>(j)] = Ball(1);
      return change(swept, at, rows, unit, &out);
    };
    const Change by_position = along(&Direction<Ball>::q);
    out.by_position.col(j) = by_position.qdd;
    out.rate_by_position.col(j) = by_position.closure_rate;
    out.by_rate.col(j) = along(&Direction<Ball>::qd).qdd;
    out.by_force.col(j) = along(&Direction<Ball>::tau).qdd;
  }
  return out;
}

/// Rates whose accelerations forces can change: independent, and not given by acceleration
/// constraints without compliance.
Indices ConstrainedLinearization::Parts::steerable(const Freedom& of, const Derivatives& d) const {
  const scene::RealNumbers<double> number(mechanism);
  Indices rigid;
  const auto& held = mechanism.acceleration_constraints;
  for (std::size_t k = 0; k < held.size(); ++k)
    if (number(held[k].compliance) == 0) rigid.push_back(static_cast<int>(k));
  const Eigen::MatrixXd J = boundedBalls(d.J).value;
  Eigen::MatrixXd left = boundedBalls(d.J_held).value(rigid, of.v);
  if (!of.dependent_v.empty())
    left -= boundedBalls(d.J_held).value(rigid, of.dependent_v) *
            solvedByColumns(J(Eigen::all, of.dependent_v), J(Eigen::all, of.v));
  return without(of.v, pivots(left, of.v));
}

/// Forces of the free joints that make the accelerations of these rates 0, the shortest:
/// F' (F F')^-1 (-qdd),  F = dqdd/dtau there.
std::vector<Ball> ConstrainedLinearization::Parts::holding(const scene::State<Ball>& at,
                                                           const Freedom& of) const {
  const Derivatives d = derivatives(at, of.rows);
  const Indices rates = steerable(of, d);
  const Balls F = d.by_force(rates, Eigen::all);
  recursive::VectorX<Ball> x = -d.qdd(rates);
  Balls FF = F * F.transpose();
  recursive::factorize(FF);
  recursive::solve(FF, x);
  const Balls tau = F.transpose() * x;
  return {tau.data(), tau.data() + tau.size()};
}

bool ConstrainedLinearization::isNeeded(const scene::Mechanism& mechanism,
                                        const std::vector<double>& qd) {
  if (ConstrainedQuantities::isConstrained(mechanism)) return true;
  std::size_t rate = 0;
  for (const scene::Link& link : mechanism.links)
    for (int k = 0; k < link.joint.ownRates(); ++k, ++rate)
      if (qd[rate] != 0 && !scene::ratesArePositionDerivatives(link.joint.kind)) return true;
  return false;
}

ConstrainedLinearization::ConstrainedLinearization(const scene::Scene& scene)
    : parts_(std::make_unique<Parts>(scene)) {
  if (parts_->motion.freedoms() == 0)
    throw scene::InputError({scene.file.string(), 0},
                            "all joints are driven, allowed: at least one that is free to move");
}
ConstrainedLinearization::~ConstrainedLinearization() = default;

void ConstrainedLinearization::close(std::vector<double>* q, std::vector<double>* qd) {
  ClosedMotion& motion = parts_->motion;
  ClosedMotion::State y = parts_->joined(*q, *qd);
  motion.impose(0, &y);
  motion.equations(y, 0);
  const double before = std::max(motion.phi(), motion.phiRateSize());
  motion.choose(y, 0);
  motion.project(&y, 0);
  motion.choose(y, 0);
  motion.project(&y, 0);
  motion.choose(y, 0);
  if (!motion.isClosed())
    throw scene::InputError(
        {parts_->scene.file.string(), 0},
        fmt::format("closures are {:.3g} apart at this state and no small change of q and qd "
                    "closes them, allowed: a state near a closed one",
                    before));
  // what is 0 but for rounding beside its likes is 0 (ClosedStates does the same)
  const auto rates = y.begin() + motion.positions();
  const auto snap = [](ClosedMotion::State::iterator from, ClosedMotion::State::iterator to,
                       double size) {
    for (; from != to; ++from)
      if (std::abs(*from) <= std::numeric_limits<double>::epsilon() * size) *from = 0;
  };
  snap(y.begin(), rates, 1);
  double fastest = 0;
  for (auto rate = rates; rate != y.end() - 1; ++rate) fastest = std::max(fastest, std::abs(*rate));
  snap(rates, y.end() - 1, fastest);
  parts_->apart(y, q, qd);
}

void ConstrainedLinearization::differentiate(const LinearizationOptions& options,
                                             Linearization* out) {
  Parts& p = *parts_;
  p.state = p.stateAt(out->q, out->qd);
  const Freedom& f = p.freedom = p.freedomAt(out->q, out->qd);
  if (!options.has_no_forces) p.state.tau = p.holding(p.state, f);
  const Derivatives& d = p.last = p.derivatives(p.state, f.rows);
  const auto n_q = static_cast<Eigen::Index>(f.q.size()),
             n_v = static_cast<Eigen::Index>(f.v.size());
  const Balls J_h = d.J(f.positional, Eigen::all);
  Balls T_q = zeros(p.n(), f.q.size()), T_v = zeros(p.n(), f.v.size()),
        K = zeros(p.n(), f.q.size());
  for (Eigen::Index k = 0; k < n_q; ++k) T_q(f.q[static_cast<std::size_t>(k)], k) = Ball(1);
  for (Eigen::Index k = 0; k < n_v; ++k) T_v(f.v[static_cast<std::size_t>(k)], k) = Ball(1);
  if (!f.dependent_q.empty())  // (1)
    T_q(f.dependent_q, Eigen::all) =
        -solved<Ball>(J_h(Eigen::all, f.dependent_q), J_h(Eigen::all, f.q));
  if (!f.dependent_v.empty()) {  // (2)
    const Balls D = d.J(Eigen::all, f.dependent_v);
    T_v(f.dependent_v, Eigen::all) = -solved<Ball>(D, d.J(Eigen::all, f.v));
    K(f.dependent_v, Eigen::all) = -solved<Ball>(D, d.rate_by_position * T_q);
  }
  const RateFrame frame(
      recursive::buildModel(p.mechanism, scene::RealNumbers<double>(p.mechanism)));
  const Balls turning = K - frame.commutator(p.state.qd) * T_q,  // (3)
      by_z = d.by_position * T_q + d.by_rate * K,                // (4)
      by_w = d.by_rate * T_v;
  Balls A = zeros(f.q.size() + f.v.size(), f.q.size() + f.v.size()),
        B = zeros(f.q.size() + f.v.size(), out->actuated.size());
  A.topLeftCorner(n_q, n_q) = turning(f.q, Eigen::all);
  A.topRightCorner(n_q, n_v) = T_v(f.q, Eigen::all);
  A.bottomLeftCorner(n_v, n_q) = by_z(f.v, Eigen::all);
  A.bottomRightCorner(n_v, n_v) = by_w(f.v, Eigen::all);
  B.bottomRows(n_v) = d.by_force(f.v, out->actuated);
  out->A = boundedBalls(A);
  out->B = boundedBalls(B);
  out->tau = boundedBalls(d.tau);
  out->qdd = boundedBalls(d.qdd);
  out->positions = f.q;
  out->rates = f.v;
  out->along = boundedBalls(T_q).value;
}

int ConstrainedLinearization::seekEquilibrium(std::vector<double>* q, std::vector<double>* qd) {
  constexpr int kMost = 100, kHalvings = 30;
  Parts& p = *parts_;
  LinearizationOptions free;
  free.has_no_forces = true;
  const recursive::Model<double> model =
      recursive::buildModel(p.mechanism, scene::RealNumbers<double>(p.mechanism));
  struct Tried {
    Linearization at;
    Eigen::VectorXd qdd, left;  ///< of independent rates; what rounding q to double leaves of it
  };
  const auto tried = [&](const std::vector<double>& from) {
    Tried out;
    out.at.q = from;
    out.at.qd.assign(qd->size(), 0.0);
    close(&out.at.q, &out.at.qd);
    differentiate(free, &out.at);
    out.qdd = out.at.qdd.value.col(0)(out.at.rates);
    double largest = 1;
    for (const double x : out.at.q) largest = std::max(largest, std::abs(x));
    const Eigen::MatrixXd K = boundedBalls(p.last.by_position).value(out.at.rates, Eigen::all);
    out.left = K.cwiseAbs().rowwise().sum() * std::numeric_limits<double>::epsilon() * largest;
    return out;
  };
  const auto rests = [](const Tried& at) {
    return (at.qdd.cwiseAbs().array() <= at.left.array()).all();
  };
  Tried now = tried(*q);
  int steps = 0;
  for (; steps < kMost && !rests(now); ++steps) {
    const auto n_q = static_cast<Eigen::Index>(now.at.positions.size());
    const Eigen::MatrixXd K = now.at.A.value.bottomLeftCorner(now.qdd.size(), n_q);
    // nearer is what the same matrix would move less (Deuflhard's natural monotonicity): the size
    // of qdd itself says nothing where some directions are stiff
    const auto of_K = K.completeOrthogonalDecomposition();
    const auto solved_for = [&](const Eigen::VectorXd& qdd) -> Eigen::VectorXd {
      return of_K.solve(qdd);
    };
    const Eigen::VectorXd z = -solved_for(now.qdd);
    const auto isNearer = [&](const Tried& at) {
      return at.at.rates == now.at.rates && solved_for(at.qdd).norm() < z.norm();
    };
    std::optional<Tried> next;
    double share = 1;
    for (int halved = 0; halved < kHalvings; ++halved, share /= 2) {
      const Eigen::VectorXd dq = now.at.along * (share * z);
      std::vector<scene::JointPosition<double>> x;
      for (const double value : now.at.q) x.push_back(scene::jointPosition(value));
      std::vector<double> slots(x.size(), 0.0), there = now.at.q;
      recursive::positionRates(model, x, std::vector<double>(dq.data(), dq.data() + dq.size()),
                               slots);
      for (std::size_t i = 0; i < there.size(); ++i) there[i] += slots[i];
      try {
        next = tried(there);
      } catch (const scene::InputError&) {  // too far for the closures
        next.reset();
        continue;
      }
      if (isNearer(*next)) break;
    }
    if (!next || !isNearer(*next)) break;
    now = *next;
  }
  if (!rests(now))
    throw scene::InputError(
        {p.scene.file.string(), 0},
        fmt::format("no equilibrium found from this guess: after {} steps of Newton's the free "
                    "rates still change by {:.3g} rad/s^2 (m/s^2) at q = {:.6g}; allowed: another "
                    "--q",
                    steps, now.qdd.cwiseAbs().maxCoeff(), fmt::join(now.at.q, ",")));
  *q = now.at.q;
  *qd = now.at.qd;
  return steps;
}

CheckResult ConstrainedLinearization::compared() {
  static const LawWords words = {"linearized mechanism",
                                 "derivatives of qdd, J qd and J along one direction", "A",
                                 "sweeps", "lagrange_multipliers"};
  const Parts& p = *parts_;
  RandomStream random(p.scene.name, 1, 0);
  Direction<Ball> along = p.still();
  for (int j = 0; j < p.n(); ++j)
    for (auto* part : {&along.q, &along.qd, &along.tau})
      if (!p.driven[static_cast<std::size_t>(j)])
        (*part)[static_cast<std::size_t>(j)] = Ball(random.uniform(-1, 1));
  const DerivedConstraints derived(p.mechanism, true, true);
  const Change by_lagrange = p.change(
      [&](const DualOfBalls& number, const scene::State<Moving>& state) {
        return derivedEquations<true>(derived, p.mechanism, number, state);
      },
      p.state, p.freedom.rows, along);
  const auto column_of = [](const std::vector<Ball>& v) { return Balls(column(v)); };
  const Derivatives& d = p.last;
  const Balls swept[] = {d.by_position * column_of(along.q) + d.by_rate * column_of(along.qd) +
                             d.by_force * column_of(along.tau),
                         d.rate_by_position * column_of(along.q) + d.J * column_of(along.qd),
                         d.J * column_of(along.q)};
  const VectorX<Ball>* const lagrange[] = {&by_lagrange.qdd, &by_lagrange.closure_rate,
                                           &by_lagrange.closure};
  TwoSides<RunningError> sides;
  const auto m = static_cast<Eigen::Index>(p.freedom.rows.size());
  sides.left.resize(p.n() + 2 * m, 1);
  sides.right.resize(p.n() + 2 * m, 1);
  Eigen::Index row = 0;
  for (int part = 0; part < 3; ++part) {
    const Bounded left = boundedBalls(swept[part]), right = boundedBalls(Balls(*lagrange[part]));
    for (Eigen::Index i = 0; i < left.value.rows(); ++i, ++row) {
      sides.left(row, 0) = RunningError(left.value(i, 0), left.bound(i, 0));
      sides.right(row, 0) = RunningError(right.value(i, 0), right.bound(i, 0));
    }
  }
  return withinBounds({words}, {sides}).front();
}

}  // namespace dynwitness::crosscheck
