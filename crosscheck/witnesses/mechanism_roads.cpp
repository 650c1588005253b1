// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/mechanism_roads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/rounded_state.hpp"
#include "crosscheck/witnesses/dense_equations.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "recursive/closed_dynamics.hpp"
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
  }
  return "?";
}

DerivedConstraints::DerivedConstraints(const scene::Mechanism& mechanism, bool fold_parameters,
                                       bool with_springs) {
  symbolic::Options options;
  options.fold_parameters = fold_parameters;
  symbolic::Equations e = symbolic::derive(mechanism, options);
  const symbolic::ClosureEquations closures = symbolic::closureEquations(mechanism, options, e);
  std::vector<scene::Attachment> points;
  for (const scene::AccelerationConstraint& held : mechanism.acceleration_constraints)
    points.push_back({held.link, held.at, {}});
  if (with_springs)
    for (const scene::Spring& spring : mechanism.springs)
      for (const scene::Attachment* end : {&spring.a, &spring.b})
        points.push_back({end->link, end->xyz, {}});
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
PartsOf<T> solved(DenseEquations<T> e, const scene::Mechanism& mechanism, const MechanismState& at,
                  const scene::State<T>& state) {
  const int k = static_cast<int>(mechanism.acceleration_constraints.size()),
            m = static_cast<int>(e.J.rows()) - k;
  std::vector<int> rows = at.rows;
  for (int i = 0; i < k; ++i) rows.push_back(m + i);
  keepRows(rows, e);
  const std::vector<char> driven = recursive::drivenRates(mechanism);
  const DenseSolution<T> x = solveDense(e, driven, state.tau, state.qdd);
  const int chosen = static_cast<int>(at.rows.size());
  PartsOf<T> out;
  part(out, MechanismQuantity::kQdd) = x.qdd;
  part(out, MechanismQuantity::kConstraintForce) = e.J.transpose() * x.nu;
  if (!at.is_redundant) part(out, MechanismQuantity::kLambda) = x.nu.head(chosen);
  part(out, MechanismQuantity::kNu) = x.nu.tail(k);
  part(out, MechanismQuantity::kDrive) = ofDriven(driven, x.tau);
  return out;
}

struct LagrangeMultipliers {
  static constexpr const char* kName = "lagrange_multipliers";
  explicit LagrangeMultipliers(const scene::Mechanism& mechanism)
      : derived(std::make_shared<DerivedConstraints>(mechanism, true, true)) {}

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState& at, const scene::State<T>& state) const {
    return solved(derivedEquations<true>(*derived, mechanism, number, state), mechanism, at, state);
  }
  std::shared_ptr<const DerivedConstraints> derived;
};

struct DenseSystem {
  static constexpr const char* kName = "dense_system";
  explicit DenseSystem(const scene::Mechanism&) {}

  template <typename Numbers, typename T = typename Numbers::Scalar>
  PartsOf<T> operator()(const scene::Mechanism& mechanism, const Numbers& number,
                        const MechanismState& at, const scene::State<T>& state) const {
    return solved(sweptEquations(mechanism, number, state), mechanism, at, state);
  }
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
    PartsOf<T> out;
    part(out, MechanismQuantity::kQdd) = column(swept.qdd);
    const VectorOf<T> force = s.closures.J.transpose() * swept.lambda;
    part(out, MechanismQuantity::kConstraintForce) = force;
    if (!at.is_redundant) part(out, MechanismQuantity::kLambda) = swept.lambda;
    std::vector<T> taken(s.model.dof(), T(0));
    recursive::inverseDynamics(s.model, state.x, state.qd, swept.qdd, s.ws, taken);
    part(out, MechanismQuantity::kDrive) =
        ofDriven<T>(s.driven, column(taken) - column(s.pull) - force);
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
    recursive::MatrixX<T> J(k, s.model.dof());
    if (k > 0) recursive::taskJacobian(s.model, held, s.ws, J);
    PartsOf<T> out;
    part(out, MechanismQuantity::kQdd) = column(qdd);
    part(out, MechanismQuantity::kConstraintForce) = J.transpose() * cws.nu;
    part(out, MechanismQuantity::kNu) = cws.nu;
    part(out, MechanismQuantity::kDrive) = ofDriven<T>(s.driven, column(tau) - column(s.pull));
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

/** Simbody solves as the dense system does, for multipliers by J M^-1 J', in axes of its own, where
    a turn stands for each of ours kEngineTurns times (engine_bound.hpp): its limit is that of the
    dense system so many times. In other axes entries mix, so that each gets the largest of its
    kind. */
class SimbodyRoad : public MechanismRoad {
 public:
  explicit SimbodyRoad(const PreparedScene& scene)
      : dense_(scene), simbody_(simbodyMechanism(scene)) {}
  const std::string& name() const override { return name_; }

  MechanismAnswer answer(const MechanismState& at) override {
    const Parts values = simbody_(at.state);
    const MechanismAnswer dense = dense_.answer(at);
    MechanismAnswer out;
    for (std::size_t q = 0; q < values.size(); ++q) {
      if (values[q].size() == 0) continue;
      const double largest = kEngineTurns * dense.parts[q].bound.maxCoeff();
      out.parts[q] = {values[q], Eigen::VectorXd::Constant(values[q].size(), largest)};
    }
    return out;
  }

 private:
  std::string name_ = "simbody";
  OwnRoad<DenseSystem> dense_;
  SimbodyMechanism simbody_;
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
  return roads;
}

}  // namespace dynwitness::crosscheck
