// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps link by link, as they are written on paper: what goes out, what comes in, and what
// Lagrange's equations say to it.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/** One link. Everything is in the axes of the moved joint frame, about its origin, linear part
    first: Z, where a joint acts, is constant there. Units: m, rad, s, kg, N. */
struct ShownLink {
  std::string name, joint, kind;  ///< kind: "revolute"
  int parent = -1;                ///< in the list; -1: the world
  int first_rate = 0;
  std::vector<std::string> rates;  ///< names; none: fixed
  Eigen::Matrix3d R;               ///< axes of the parent's frame to these
  Eigen::Vector3d p;               ///< this frame's origin in the parent's
  Eigen::MatrixXd Z;               ///< 6 x axes
  double d = 0;                    ///< n^2 J of the joint's rotor
  Matrix6d M;                      ///< the link's inertia
  Matrix6d M_C;                    ///< composite: of all that hangs on it, joints locked

  // Newton and Euler at the given qdd
  Vector6d v, a;  ///< a with a_0 = - gravity
  Vector6d own;   ///< M a + v x* M v - loads: what the link alone needs
  Vector6d f;     ///< through the joint
  /// By axis: Z'f, d qdd, what a gyroscopic rotor on the parent feels of the parent's turning,
  /// springs and friction; their sum is tau.
  Eigen::VectorXd Z_f, rotor, gyroscopic, passive;

  // articulated bodies at the tau that comes of it
  Matrix6d M_A;          ///< articulated: of all that hangs on it, joints free
  Eigen::MatrixXd D;     ///< d + Z' M_A Z
  Matrix6d P, P_M;       ///< projections of force and of inertia, as the sweep makes them
  double projector = 0;  ///< largest entry of P P - P + M_A Z D^-1 d D^-1 Z'
  double asymmetry = 0;  ///< largest of P M_A - (P M_A)', P times M_A
};

struct ShownSweep {
  scene::State<double> state;  ///< with tau
  std::vector<ShownLink> links;
  Vector6d a_0;  ///< of the world: - gravity
  std::vector<std::string> rates;
  Eigen::MatrixXd M;                    ///< by Lagrange's derivation, as below
  Eigen::VectorXd c, g, tau, lagrange;  ///< tau of the sweep; M qdd + c + g + friction - loads
  bool has_more = false;                ///< friction or loads, beside M qdd + c + g
  Eigen::VectorXd qdd;                  ///< by articulated bodies, of tau: must be the given one
};

/// @param state  q, qd, qdd of the mechanism's sizes
/// @throws scene::InputError  what Command::kSweep refuses
ShownSweep shownSweep(const scene::Scene& scene, const scene::State<double>& state);

}  // namespace dynwitness::crosscheck
