// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/mechanism_roads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <Eigen/LU>

#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/rounded_state.hpp"
#include "crosscheck/witnesses/dense_equations.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "recursive/closed_dynamics.hpp"
#include "recursive/constrained_reactions.hpp"
#include "recursive/hybrid_dynamics.hpp"

namespace dynwitness::recursive::detail {
template <>
struct Rounds<crosscheck::AdjointError> : std::true_type {};
}  // namespace dynwitness::recursive::detail

namespace dynwitness::crosscheck {

const char* name(MechanismQuantity quantity) {
  switch (quantity) {
    case MechanismQuantity::kQdd:
      return "mechanism qdd";
    case MechanismQuantity::kConstraintForce:
      return "mechanism constraint force";
    case MechanismQuantity::kLambda:
      return "mechanism lambda";
    case MechanismQuantity::kNu:
      return "mechanism nu";
    case MechanismQuantity::kDrive:
      return "mechanism drive force";
    case MechanismQuantity::kReactions:
      return "mechanism reactions";
  }
  return "?";
}

std::vector<scene::Attachment> constrainedFrames(const scene::Mechanism& mechanism,
                                                 bool with_springs) {
  std::vector<scene::Attachment> points;
  for (const scene::AccelerationConstraint& held : mechanism.acceleration_constraints)
    points.push_back({held.link, held.at, {}});
  if (with_springs)
    for (const scene::Spring& spring : mechanism.springs)
      for (const scene::Attachment* end : {&spring.a, &spring.b})
        points.push_back({end->link, end->xyz, {}});
  return points;
}

DerivedReactions::DerivedReactions(const scene::Mechanism& mechanism, bool fold_parameters) {
  symbolic::Options options;
  options.fold_parameters = fold_parameters;
  const symbolic::Reactions cut =
      symbolic::reactionsAlong(mechanism, options, constrainedFrames(mechanism, true));
  count = static_cast<int>(cut.lambda.size());
  closure_rows = static_cast<int>(cut.by_closure.size());
  frames = static_cast<int>(cut.by_frame.size()) / 12;
  std::vector<symbolic::Node> outputs = cut.lambda;
  for (const auto* rows : {&cut.by_closure, &cut.by_frame})
    for (const auto& row : *rows) outputs.insert(outputs.end(), row.begin(), row.end());
  program = symbolic::compile(cut.graph, outputs);
}

DerivedConstraints::DerivedConstraints(const scene::Mechanism& mechanism, bool fold_parameters,
                                       bool with_springs) {
  symbolic::Options options;
  options.fold_parameters = fold_parameters;
  symbolic::Equations e = symbolic::derive(mechanism, options);
  const symbolic::ClosureEquations closures = symbolic::closureEquations(mechanism, options, e);
  const std::vector<scene::Attachment> points = constrainedFrames(mechanism, with_springs);
  const symbolic::ClosureEquations places = symbolic::frameEquations(mechanism, options, points, e);
  n = e.dof();
  closure_rows = static_cast<int>(closures.phi.size());
  frames = static_cast<int>(points.size());
  std::vector<symbolic::Node> outputs = symbolic::massCoriolisGravity(e);
  const auto add = [&outputs](const std::vector<symbolic::Node>& more) {
    outputs.insert(outputs.end(), more.begin(), more.end());
  };
  add(e.Q);
  for (const symbolic::ClosureEquations* rows : {&closures, &places}) {
    add(rows->phi);
    for (const auto& row : rows->J) add(row);
    add(rows->gamma);
  }
  program = symbolic::compile(e.graph, outputs);
}

namespace {

using Parts = std::array<Eigen::VectorXd, std::size(kMechanismQuantities)>;

template <typename T>
using PartsOf = std::array<VectorOf<T>, std::size(kMechanismQuantities)>;

template <typename T>
VectorOf<T>& part(PartsOf<T>& parts, MechanismQuantity quantity) {
  return parts[static_cast<std::size_t>(quantity)];
}

/// Of the rates that drives give.
template <typename T>
VectorOf<T> ofDriven(const std::vector<char>& driven, const VectorOf<T>& all) {
  VectorOf<T> out(std::count(driven.begin(), driven.end(), 1));
  for (std::size_t i = 0, k = 0; i < driven.size(); ++i)
    if (driven[i]) out(static_cast<Eigen::Index>(k++)) = all(static_cast<Eigen::Index>(i));
  return out;
}

/// The dense system of a whole mechanism, solved for the rows that stand for all.
template <typename T>
struct Solved {
  Solved(DenseEquations<T> e, const scene::Mechanism& mechanism, const MechanismState& at,
         const scene::State<T>& state)
      : forces(VectorOf<T>::Constant(e.J.rows(), T(0))) {
    const int k = static_cast<int>(mechanism.acceleration_constraints.size()),
              m = static_cast<int>(e.J.rows()) - k;
    std::vector<int> rows = at.rows;
    for (int i = 0; i < k; ++i) rows.push_back(m + i);
    keepRows(rows, e);
    const std::vector<char> driven = recursive::drivenRates(mechanism);
    const DenseSolution<T> x = solveDense(e, driven, state.tau, state.qdd);
    const int chosen = static_cast<int>(at.rows.size());
    qdd = x.qdd;
    for (std::size_t i = 0; i < rows.size(); ++i)
      forces(rows[i]) = x.nu(static_cast<Eigen::Index>(i));
    part(parts, MechanismQuantity::kQdd) = x.qdd;
    part(parts, MechanismQuantity::kConstraintForce) = e.J.transpose() * x.nu;
    if (!at.is_redundant) part(parts, MechanismQuantity::kLambda) = x.nu.head(chosen);
    part(parts, MechanismQuantity::kNu) = x.nu.tail(k);
    part(parts, MechanismQuantity::kDrive) = ofDriven(driven, x.tau);
  }
  PartsOf<T> parts;         ///< without reactions
  VectorOf<T> qdd, forces;  ///< n; of all equations, 0 of those that others stand for
};

/// Newton and Euler with the wrenches of constraints as outer loads.
template <typename Numbers, typename T = typename Numbers::Scalar>
VectorOf<T> reactionsUnder(const scene::Mechanism& mechanism, const Numbers& number,
                           const scene::State<T>& state, const std::vector<T>& qdd,
                           const VectorOf<T>& lambda, const VectorOf<T>& nu) {
  recursive::MechanismOfJoints<T> of(mechanism, number);
  std::vector<T> out(6 * (mechanism.links.size() - 1), T(0));
  recursive::constrainedReactions(mechanism, number, state.x, state.qd, qdd, lambda, nu, of, out);
  return column(out);
}

struct LagrangeMultipliers {
  static constexpr const char* kName = "lagrange_multipliers";
  explicit LagrangeMultipliers(const scene::Mechanism& mechanism)
      : derived(std::make_shared<DerivedConstraints>(mechanism, true, true)),
        cut(std::make_shared<DerivedReactions>(mechanism, true)) {}

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState& at, const scene::State<T>& state) const {
    const DenseEquations<T> e = derivedEquations<true>(*derived, mechanism, number, state);
    Solved<T> x(e, mechanism, at, state);
    scene::State<T> moving = state;
    moving.qdd.assign(x.qdd.begin(), x.qdd.end());
    part(x.parts, MechanismQuantity::kReactions) =
        derivedReactions(*cut, e, mechanism, number, moving, x.forces, pullByLength(number));
    return x.parts;
  }
  std::shared_ptr<const DerivedConstraints> derived;
  std::shared_ptr<const DerivedReactions> cut;
};

struct DenseSystem {
  static constexpr const char* kName = "dense_system";
  explicit DenseSystem(const scene::Mechanism& mechanism) {
    if (!mechanism.hasMimics()) cut = symbolic::freed(mechanism);
  }

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState& at, const scene::State<T>& state) const {
    Solved<T> x(sweptEquations(mechanism, number, state), mechanism, at, state);
    const auto k = static_cast<Eigen::Index>(mechanism.acceleration_constraints.size());
    part(x.parts, MechanismQuantity::kReactions) =
        cut ? cutForces(*cut, number, state, x.qdd, x.forces)
            : reactionsUnder(mechanism, number, state, std::vector<T>(x.qdd.begin(), x.qdd.end()),
                             VectorOf<T>(x.forces.head(x.forces.size() - k)),
                             VectorOf<T>(x.forces.tail(k)));
    return x.parts;
  }
  /// None where joints follow others: no sweep that solves holds these, and lagrange_multipliers
  /// would be compared with its own cuts alone.
  std::optional<symbolic::Freed> cut;
};

/// What both sweeps start from: the model, the closures' equations, the springs' pull.
template <typename Numbers>
struct Swept {
  using T = typename Numbers::Scalar;
  Swept(const scene::Mechanism& mechanism, const Numbers& number, const scene::State<T>& state)
      : model(recursive::buildModel(mechanism, number)),
        ws(model),
        closures(recursive::buildConstraints(mechanism, number, model)),
        driven(recursive::drivenRates(mechanism)),
        pull(model.dof(), T(0)),
        tau(state.tau) {
    recursive::constraintEquations(model, state.x, state.qd, ws, closures);
    recursive::addSpringForces(model, recursive::buildPointSprings(mechanism, number, model),
                               closures.X_W, ws, pull);
    for (std::size_t i = 0; i < tau.size(); ++i) tau[i] += pull[i];
  }
  recursive::Model<T> model;
  recursive::Workspace<T> ws;
  recursive::Constraints<T> closures;
  std::vector<char> driven;
  std::vector<T> pull, tau;  ///< of the springs; with them
};

void requireOwnRates(const scene::Mechanism& mechanism) {
  if (mechanism.hasMimics())
    throw std::invalid_argument(
        "joints follow others (mimic), and the constrained sweeps solve for each joint where they "
        "pass it");
}

/// A sweep counts its equations by pivots, and leaves out what it takes for dependent: fewer than
/// were asked for are another mechanism's.
void requireAll(int counted, int asked) {
  if (counted < asked)
    throw std::runtime_error(fmt::format(
        "of {} constraint equations the sweep can tell {} apart: the next pivot of N_0 is below "
        "cbrt(eps)^2 of the first",
        asked, counted));
}

struct LoopsEliminated {
  static constexpr const char* kName = "loops_eliminated";
  explicit LoopsEliminated(const scene::Mechanism& mechanism) {
    requireOwnRates(mechanism);
    if (!mechanism.acceleration_constraints.empty())
      throw std::invalid_argument("no sweep eliminates loops under acceleration constraints");
  }

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState& at, const scene::State<T>& state) const {
    Swept<Numbers> s(mechanism, number, state);
    const auto swept = recursive::closedForwardDynamics(
        s.model, state.x, state.qd, s.tau, s.closures, s.ws, false, s.driven, state.qdd);
    requireAll(swept.rank, static_cast<int>(at.rows.size()));
    PartsOf<T> out;
    part(out, MechanismQuantity::kQdd) = column(swept.qdd);
    const VectorOf<T> force = s.closures.J.transpose() * swept.lambda;
    part(out, MechanismQuantity::kConstraintForce) = force;
    if (!at.is_redundant) part(out, MechanismQuantity::kLambda) = swept.lambda;
    std::vector<T> taken(s.model.dof(), T(0));
    recursive::inverseDynamics(s.model, state.x, state.qd, swept.qdd, s.ws, taken);
    part(out, MechanismQuantity::kDrive) =
        ofDriven<T>(s.driven, column(taken) - column(s.pull) - force);
    part(out, MechanismQuantity::kReactions) =
        reactionsUnder(mechanism, number, state, swept.qdd, swept.lambda, VectorOf<T>());
    return out;
  }
};

struct HybridSweep {
  static constexpr const char* kName = "hybrid_sweep";
  explicit HybridSweep(const scene::Mechanism& mechanism) { requireOwnRates(mechanism); }

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState&, const scene::State<T>& state) const {
    Swept<Numbers> s(mechanism, number, state);
    const auto held =
        recursive::accelerationConstraints(mechanism, number, s.model, state.x, state.qd, s.ws);
    const int k = static_cast<int>(held.size());
    recursive::ConstraintWorkspace<T> cws(s.model, k);
    std::vector<T> qdd = state.qdd, tau = s.tau;
    recursive::hybridDynamics(s.model, state.x, state.qd, s.driven, held, s.ws, cws, qdd, tau);
    requireAll(cws.of_N.rank(), k);
    recursive::MatrixX<T> J(k, s.model.dof());
    if (k > 0) recursive::taskJacobian(s.model, held, s.ws, J);
    PartsOf<T> out;
    part(out, MechanismQuantity::kQdd) = column(qdd);
    part(out, MechanismQuantity::kConstraintForce) = J.transpose() * cws.nu;
    part(out, MechanismQuantity::kNu) = cws.nu;
    part(out, MechanismQuantity::kDrive) = ofDriven<T>(s.driven, column(tau) - column(s.pull));
    part(out, MechanismQuantity::kReactions) =
        reactionsUnder(mechanism, number, state, qdd, VectorOf<T>(), VectorOf<T>(cws.nu));
    return out;
  }
};

/// A road whose every rounding is ours.
template <typename Formulas>
class OwnRoad : public MechanismRoad {
 public:
  explicit OwnRoad(const PreparedScene& scene) : scene_(scene), formulas_(scene.mechanism()) {}
  const std::string& name() const override { return name_; }

  MechanismAnswer answer(const MechanismState& at) override {
    const scene::Mechanism& mechanism = scene_.mechanism();
    const Parts values = formulas_(mechanism, scene::RealNumbers<double>(mechanism), at, at.state);
    AdjointTape tape;
    const AdjointTape::Recording recording(tape);
    scene::State<RunningError> known = runningErrorState(at.state, mechanism);
    if (at.is_redundant) {
      for (std::size_t i = 0; i < known.x.size(); ++i)
        known.x[i] = roundedPosition(at.state.x[i].q);
      known.qd = rounded(at.state.qd);
    }
    const PartsOf<AdjointError> on_tape =
        formulas_(mechanism, AdjointErrorNumbers(mechanism), at, adjointState(known));
    Eigen::Index count = 0;
    for (const auto& one : on_tape) count += one.size();
    MatrixOf<AdjointError> results(count, 1);
    Eigen::Index from = 0;
    for (const auto& one : on_tape)
      for (Eigen::Index i = 0; i < one.size(); ++i) results(from++, 0) = one(i);
    const Eigen::VectorXd bounds =
        tape.firstOrder(Eigen::MatrixXd::Identity(count, count), results);
    MechanismAnswer out;
    from = 0;
    for (std::size_t q = 0; q < values.size(); ++q) {
      out.parts[q] = {values[q], bounds.segment(from, on_tape[q].size())};
      from += on_tape[q].size();
    }
    return out;
  }

 private:
  PreparedScene scene_;
  std::string name_ = Formulas::kName;
  Formulas formulas_;
};

/** Limits of an engine that solves as the dense system does, in axes of its own, where a turn
    stands for `turns` of ours (engine_bound.hpp): those of the dense system so many times. In
    other axes entries mix, so that each gets the largest of its kind; of reactions, forces and
    moments are two. */
void giveLimits(const MechanismAnswer& dense, double turns, MechanismAnswer& out) {
  for (std::size_t q = 0; q < out.parts.size(); ++q) {
    const Eigen::Index count = out.parts[q].value.size();
    if (count == 0) continue;
    const Eigen::VectorXd& bound = dense.parts[q].bound;
    out.parts[q].bound = Eigen::VectorXd::Constant(count, turns * bound.maxCoeff());
    if (kMechanismQuantities[q] != MechanismQuantity::kReactions) continue;
    double largest[] = {0, 0};
    for (Eigen::Index i = 0; i < bound.size(); ++i)
      largest[i / 3 % 2] = std::max(largest[i / 3 % 2], bound(i));
    for (Eigen::Index i = 0; i < bound.size(); ++i)
      out.parts[q].bound(i) = turns * largest[i / 3 % 2];
  }
}

class SimbodyRoad : public MechanismRoad {
 public:
  explicit SimbodyRoad(const PreparedScene& scene)
      : dense_(scene), simbody_(simbodyMechanism(scene)) {}
  const std::string& name() const override { return name_; }

  MechanismAnswer answer(const MechanismState& at) override {
    const Parts values = simbody_(at.state);
    MechanismAnswer out;
    for (std::size_t q = 0; q < values.size(); ++q) out.parts[q].value = values[q];
    giveLimits(dense_.answer(at), kEngineTurns, out);
    return out;
  }
  std::string whyLeftOut(MechanismQuantity quantity) const override {
    return quantity == MechanismQuantity::kReactions || quantity == MechanismQuantity::kDrive
               ? "beside rotors its system is solved here, without it"
               : "an engine's multipliers are in units of its own; J' lambda is compared";
  }

 private:
  std::string name_ = "simbody";
  OwnRoad<DenseSystem> dense_;
  SimbodyMechanism simbody_;
};

/** MuJoCo's equations, solved as the dense system is. An orientation made of quaternions loses
    10 / 3 of what a product of matrices does, and forces are gathered in world axes, which leaves
    an error of each force besides (mujoco.cpp): what it does to the solution, |K^-1| tells. */
class MujocoRoad : public MechanismRoad {
 public:
  explicit MujocoRoad(const PreparedScene& scene)
      : scene_(scene), dense_(scene), mujoco_(mujocoMechanism(scene)) {}
  const std::string& name() const override { return name_; }

  MechanismAnswer answer(const MechanismState& at) override {
    constexpr double kTurns = kEngineTurns * 10.0 / 3;
    const MujocoEquations said = mujoco_(at.state);
    const Solved<double> solved(*said.equations, scene_.mechanism(), at, at.state);
    MechanismAnswer out;
    for (std::size_t q = 0; q < solved.parts.size(); ++q) out.parts[q].value = solved.parts[q];
    giveLimits(dense_.answer(at), kTurns, out);
    addForceError(*said.equations, at, said.force_error(solved.qdd), out);
    return out;
  }
  std::string whyLeftOut(MechanismQuantity) const override {
    return "its equations in joint coordinates are solved here, which tell no reactions";
  }

 private:
  /// What an error of each force does to the solution: columns of K^-1, K as in solveDense().
  void addForceError(DenseEquations<double> e, const MechanismState& at, double error,
                     MechanismAnswer& out) const {
    const auto k = static_cast<Eigen::Index>(scene_.mechanism().acceleration_constraints.size());
    std::vector<int> rows = at.rows;
    for (Eigen::Index i = e.J.rows() - k; i < e.J.rows(); ++i) rows.push_back(static_cast<int>(i));
    keepRows(rows, e);
    const std::vector<char> driven = recursive::drivenRates(scene_.mechanism());
    std::vector<int> free, given;
    for (int i = 0; i < static_cast<int>(driven.size()); ++i)
      (driven[static_cast<std::size_t>(i)] ? given : free).push_back(i);
    const auto f = static_cast<Eigen::Index>(free.size()), m = e.J.rows();
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(f + m, f + m);
    K.topLeftCorner(f, f) = e.M(free, free);
    K.bottomLeftCorner(m, f) = e.J(Eigen::all, free);
    K.topRightCorner(f, m) = K.bottomLeftCorner(m, f).transpose();
    K.diagonal().tail(m) = -e.C;
    const Eigen::MatrixXd moved =
        K.fullPivLu().solve(Eigen::MatrixXd::Identity(f + m, f)).cwiseAbs();
    const Eigen::VectorXd by = error * moved.rowwise().sum();
    const auto add = [&out](MechanismQuantity quantity, const Eigen::VectorXd& more) {
      Eigen::VectorXd& bound = out[quantity].bound;
      if (bound.size() > 0) bound.array() += more.size() > 0 ? more.maxCoeff() : 0;
    };
    const Eigen::VectorXd of_forces = e.J.cwiseAbs().transpose() * by.tail(m);
    add(MechanismQuantity::kQdd, by.head(f));
    add(MechanismQuantity::kConstraintForce, of_forces);
    add(MechanismQuantity::kLambda, by.segment(f, m - k));
    add(MechanismQuantity::kNu, by.tail(k));
    add(MechanismQuantity::kDrive,
        (e.M(given, free).cwiseAbs() * by.head(f) + of_forces(given)).array() + error);
  }

  PreparedScene scene_;
  std::string name_ = "mujoco";
  OwnRoad<DenseSystem> dense_;
  MujocoMechanism mujoco_;
};

class CertifiedMechanism : public MechanismRoad {
 public:
  explicit CertifiedMechanism(const PreparedScene& scene)
      : scene_(scene), formulas_(scene.mechanism()) {}
  const std::string& name() const override { return name_; }

  MechanismAnswer answer(const MechanismState& at) override {
    constexpr long kFirstBits = 128, kMostBits = 4096;
    const scene::Mechanism& mechanism = scene_.mechanism();
    for (long bits = kFirstBits;; bits *= 2) {
      const BallPrecision precision(bits);
      const PartsOf<Ball> balls =
          formulas_(mechanism, BallNumbers(mechanism), at, ballState(at.state, mechanism));
      if (std::all_of(balls.begin(), balls.end(), isSharp)) return inDoubles(balls);
      if (2 * bits <= kMostBits) continue;
      if (std::all_of(balls.begin(), balls.end(), isFinite)) return inDoubles(balls);
      throw std::runtime_error(
          "no enclosure: the equations are singular at this state as far as 4096 bits can tell");
    }
  }

 private:
  static bool isFinite(const VectorOf<Ball>& part) {
    return std::all_of(part.begin(), part.end(), [](const Ball& x) { return x.isFinite(); });
  }
  static bool isSharp(const VectorOf<Ball>& part) {
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
    double largest = 0, radius = 0;
    for (const Ball& x : part) {
      largest = std::max(largest, std::abs(x.mid()));
      radius = std::max(radius, x.radius());
    }
    return isFinite(part) &&
           radius <= std::max(kEpsilon * kEpsilon * largest, std::numeric_limits<double>::min());
  }
  static MechanismAnswer inDoubles(const PartsOf<Ball>& balls) {
    constexpr double kHalfUlp = std::numeric_limits<double>::epsilon() / 2;
    MechanismAnswer out;
    for (std::size_t q = 0; q < balls.size(); ++q) {
      out.parts[q] = {Eigen::VectorXd(balls[q].size()), Eigen::VectorXd(balls[q].size())};
      for (Eigen::Index i = 0; i < balls[q].size(); ++i) {
        const double middle = balls[q](i).mid();
        out.parts[q].value(i) = middle;
        out.parts[q].bound(i) = balls[q](i).radius() + kHalfUlp * std::abs(middle);
      }
    }
    return out;
  }

  PreparedScene scene_;
  std::string name_ = "certified";
  LagrangeMultipliers formulas_;
};

template <typename Road>
NamedRoad made(const char* name, const PreparedScene& scene) {
  try {
    return {name, std::shared_ptr<MechanismRoad>(std::make_shared<Road>(scene))};
  } catch (const std::exception& error) {
    return {name, Refusal{error.what()}};
  }
}

}  // namespace

std::shared_ptr<MechanismRoad> certifiedMechanism(const PreparedScene& scene) {
  return std::make_shared<CertifiedMechanism>(scene);
}

std::vector<NamedRoad> mechanismRoads(const PreparedScene& scene) {
  std::vector<NamedRoad> roads;
  if (scene.mechanism().closures.empty())
    roads.push_back(made<OwnRoad<HybridSweep>>(HybridSweep::kName, scene));
  else
    roads.push_back(made<OwnRoad<LoopsEliminated>>(LoopsEliminated::kName, scene));
  roads.push_back(made<OwnRoad<LagrangeMultipliers>>(LagrangeMultipliers::kName, scene));
  roads.push_back(made<OwnRoad<DenseSystem>>(DenseSystem::kName, scene));
  roads.push_back(made<SimbodyRoad>("simbody", scene));
  roads.push_back(made<MujocoRoad>("mujoco", scene));
  return roads;
}

}  // namespace dynwitness::crosscheck
