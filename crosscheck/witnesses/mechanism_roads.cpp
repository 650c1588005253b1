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
#include "crosscheck/witnesses/lagrange.hpp"
#include "crosscheck/witnesses/mechanism_formulas.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"

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

DerivedReactions::DerivedReactions(const scene::Mechanism& mechanism, bool fold_parameters)
    : DerivedReactions(DerivedPrograms(mechanism, fold_parameters).cut()) {}

DerivedReactions::DerivedReactions(const symbolic::Reactions& cut) {
  count = static_cast<int>(cut.lambda.size());
  closure_rows = static_cast<int>(cut.by_closure.size());
  frames = static_cast<int>(cut.by_frame.size()) / 12;
  std::vector<symbolic::Node> outputs = cut.lambda;
  for (const auto* rows : {&cut.by_closure, &cut.by_frame})
    for (const auto& row : *rows) outputs.insert(outputs.end(), row.begin(), row.end());
  program = symbolic::compile(cut.graph, outputs);
}

DerivedConstraints::DerivedConstraints(const scene::Mechanism& mechanism, bool fold_parameters,
                                       bool with_springs)
    : DerivedConstraints(DerivedPrograms(mechanism, fold_parameters), with_springs) {}

DerivedConstraints::DerivedConstraints(const DerivedPrograms& derived, bool with_springs) {
  const scene::Mechanism& mechanism = derived.mechanism();
  const symbolic::Options& options = derived.options();
  symbolic::Equations& e = derived.withMass();
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

void requireOwnRates(const scene::Mechanism& mechanism) {
  if (mechanism.hasMimics())
    throw std::invalid_argument(
        "joints follow others (mimic), and the constrained sweeps solve for each joint where they "
        "pass it");
}

namespace {

using Parts = std::array<Eigen::VectorXd, std::size(kMechanismQuantities)>;

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
    MatrixX<AdjointError> results(count, 1);
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
  static bool isFinite(const VectorX<Ball>& part) {
    return std::all_of(part.begin(), part.end(), [](const Ball& x) { return x.isFinite(); });
  }
  static bool isSharp(const VectorX<Ball>& part) {
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
