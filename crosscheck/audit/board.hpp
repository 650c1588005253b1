// SPDX-License-Identifier: GPL-3.0-or-later
// Counterexamples for the board: a bundled robot, its state, and both sides of an equation as
// numbers. What is so is what the sweeps of recursive/ answer.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "crosscheck/audit/robot.hpp"
#include "recursive/constrained_dynamics.hpp"
#include "scene/scene.hpp"

namespace dynwitness::audit {

/// Four digits; what is below those of its neighbours is 0.
std::string onBoard(double x);

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
  explicit OnTheBoard(const std::string& name, double rate = 0, double q = 0.5);
  /// The motion that tau causes, into qdd and ws.
  void move(recursive::Terms terms = recursive::Terms::all());

  std::size_t n() const { return qd.size(); }
  recursive::Matrix6<double> M_A(std::size_t i) const;
  recursive::Vector6<double> F(std::size_t i) const;
  recursive::Vector6<double> A(std::size_t i) const;  ///< bias
  recursive::Matrix6<double> T_V(std::size_t i) const;
  recursive::Matrix6<double> T_F(std::size_t i) const;
  static recursive::Vector6<double> Z() { return recursive::Vector6<double>::Unit(5); }
  recursive::Matrix6<double> P(std::size_t i) const;
  recursive::Vector6<double> gravityAtBase() const;

  scene::Scene scene;
  recursive::Model<double> model;
  recursive::Workspace<double> ws;
  std::vector<scene::JointPosition<double>> x;
  std::vector<double> qd, qdd, tau;
};

/// A rigid body as point masses, not all of them positive: one at its centre of mass, and along the
/// axes of its second moments `sum m x x'` a pair at a distance of 1 m.
PointMasses<double> pointMassesOf(const RigidInertia<double>& body);

/// The robot on the board as point masses on joints, which knows neither sweeps nor six-vectors:
/// another road to what its columns say.
Robot<double> pointMassesOf(const OnTheBoard& arm);

/// The double pendulum, whose elbow is held along the x axis of the lower rod (or whose lower rod
/// along another of the six directions), and what holds it.
struct HeldElbow {
  explicit HeldElbow(double rate, int direction = 0);
  /// The chapter's: the load that the link puts on what holds it.
  double nu() const { return -cws.nu(0); }
  recursive::Vector6<double> E(std::size_t i) const;

  OnTheBoard arm;
  recursive::LinkConstraint<double> held;
  recursive::ConstraintWorkspace<double> cws;
};

// compiled once (board.cpp)
extern template struct PointMasses<double>;
extern template struct Robot<double>;

}  // namespace dynwitness::audit
