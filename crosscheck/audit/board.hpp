// SPDX-License-Identifier: GPL-3.0-or-later
// Counterexamples for the board: a bundled robot, its state, and both sides of an equation as
// numbers. What is so is what the sweeps of recursive/ answer.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

#include "crosscheck/audit/robot.hpp"
#include "recursive/build_model.hpp"
#include "recursive/constrained_dynamics.hpp"
#include "scene/scene.hpp"

namespace dynwitness::audit {

/// Four digits; what is below those of its neighbours is 0.
inline std::string onBoard(double x) {
  return fmt::format("{:.4g}", std::abs(x) < 1e-12 ? 0.0 : x);
}

using SixNames = std::array<const char*, 6>;
inline constexpr SixNames kForceNames = {"`f_x` [N]",   "`f_y` [N]",   "`f_z` [N]",
                                         "`m_x` [N m]", "`m_y` [N m]", "`m_z` [N m]"};
inline constexpr SixNames kAccelerationNames = {"`vd_x` [m/s^2]",   "`vd_y` [m/s^2]",
                                                "`vd_z` [m/s^2]",   "`wd_x` [rad/s^2]",
                                                "`wd_y` [rad/s^2]", "`wd_z` [rad/s^2]"};

/// A row a component: its name, what is printed, what is so. Left out where both are 0.
template <typename Names, typename Printed, typename So>
Rows componentRows(const Names& names, const Printed& printed, const So& so) {
  Rows rows;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const std::string left = onBoard(printed[i]), right = onBoard(so[i]);
    if (left != "0" || right != "0") rows.push_back({names[k], left, right});
  }
  return rows;
}

/// A bundled robot with every q = 0.5 and the same rate everywhere, and the chapter's letters as
/// the articulated-body sweep leaves them; Z, A, P: for revolute joints.
struct OnTheBoard {
  explicit OnTheBoard(const std::string& name, double rate = 0, double q = 0.5)
      : scene(scene::findScene(name)),
        model(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism))),
        ws(model),
        x(static_cast<std::size_t>(model.positions), scene::jointPosition(q)),
        qd(static_cast<std::size_t>(model.dof()), rate),
        qdd(qd.size(), 0.0),
        tau(qd.size(), 0.0) {
    move();
  }
  /// The motion that tau causes, into qdd and ws.
  void move(recursive::Terms terms = recursive::Terms::all()) {
    recursive::forwardDynamics(model, x, qd, tau, ws, qdd, terms);
  }

  std::size_t n() const { return qd.size(); }
  recursive::Matrix6<double> M_A(std::size_t i) const { return ws.M_A[i].matrix(); }
  recursive::Vector6<double> F(std::size_t i) const { return ws.f[i].vector(); }
  recursive::Vector6<double> A(std::size_t i) const { return ws.c[i].vector(); }  ///< bias
  recursive::Matrix6<double> T_V(std::size_t i) const { return ws.X_up[i].motionMatrix(); }
  recursive::Matrix6<double> T_F(std::size_t i) const { return T_V(i).transpose(); }
  static recursive::Vector6<double> Z() { return recursive::Vector6<double>::Unit(5); }
  recursive::Matrix6<double> P(std::size_t i) const {
    return recursive::Matrix6<double>::Identity() - M_A(i) * Z() * (1 / ws.D[i]) * Z().transpose();
  }
  recursive::Vector6<double> gravityAtBase() const {
    recursive::Vector6<double> a = recursive::Vector6<double>::Zero();
    a.head<3>() = -model.gravity;
    return a;
  }

  scene::Scene scene;
  recursive::Model<double> model;
  recursive::Workspace<double> ws;
  std::vector<scene::JointPosition<double>> x;
  std::vector<double> qd, qdd, tau;
};

/// A rigid body as point masses, not all of them positive: one at its centre of mass, and along the
/// axes of its second moments `sum m x x'` a pair at a distance of 1 m.
inline PointMasses<double> pointMassesOf(const RigidInertia<double>& body) {
  const Vector3<double> c =
      body.mass == 0 ? Vector3<double>::Zero() : Vector3<double>(body.h / body.mass);
  const Matrix3<double> I = body.I.matrix();
  const Matrix3<double> moments =
      Matrix3<double>::Identity() * (I.trace() / 2) - I - c * body.h.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3<double>> axes(moments);
  PointMasses<double> out{{body.mass - axes.eigenvalues().sum()}, {c}};
  for (int k = 0; k < 3; ++k)
    for (const int side : {-1, 1}) {
      out.m.push_back(axes.eigenvalues()(k) / 2);
      out.r.push_back(c + side * axes.eigenvectors().col(k));
    }
  return out;
}

/// The robot on the board as point masses on joints, which knows neither sweeps nor six-vectors:
/// another road to what its columns say.
inline Robot<double> pointMassesOf(const OnTheBoard& arm) {
  Robot<double> robot;
  for (std::size_t i = 0; i < arm.n(); ++i) {
    const auto& link = arm.model.links[i];
    robot.parent.push_back(link.parent);
    robot.kind.push_back(link.kind);
    robot.R.push_back(link.X_tree.R.transpose());
    robot.r.push_back(link.X_tree.p);
    robot.body.push_back(pointMassesOf(link.M));
    robot.rotor.push_back(link.rotor);
  }
  robot.x = arm.x;
  robot.qd = arm.qd;
  robot.qdd = arm.qdd;
  robot.tau = arm.tau;
  robot.gravity = arm.model.gravity;
  return robot;
}

/// The double pendulum, whose elbow is held along the x axis of the lower rod (or whose lower rod
/// along another of the six directions), and what holds it.
struct HeldElbow {
  explicit HeldElbow(double rate, int direction = 0)
      : arm("double_pendulum", rate), cws(arm.model, 1) {
    held.link = 1;
    held.A = recursive::Vector6<double>::Unit(direction);
    held.b = VectorXd::Zero(1);
    recursive::constrainedForwardDynamics(arm.model, arm.x, arm.qd, arm.tau, {held}, arm.ws, cws,
                                          arm.qdd);
  }
  using VectorXd = Eigen::Matrix<double, Eigen::Dynamic, 1>;
  /// The chapter's: the load that the link puts on what holds it.
  double nu() const { return -cws.nu(0); }
  recursive::Vector6<double> E(std::size_t i) const { return cws.E[i].col(0); }

  OnTheBoard arm;
  recursive::LinkConstraint<double> held;
  recursive::ConstraintWorkspace<double> cws;
};

}  // namespace dynwitness::audit
