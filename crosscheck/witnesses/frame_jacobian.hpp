// SPDX-License-Identifier: GPL-3.0-or-later
// How a point of a link moves with the rates, and how far an engine's numbers for it may be off.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/witnesses/prepared_scene.hpp"
#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// A point of a link of the scene.
struct FramePoint {
  int link = -1;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< in the link's axes, from its origin [m]
};

/// Of the link that most joints move, the last of several, a point that is no origin of anything;
/// its coordinates are the same in single precision.
FramePoint farthestPoint(const scene::Mechanism& mechanism);

/// "link 'hand' at (0.125, -0.25, 0.375)"
std::string wordsOf(const FramePoint& point, const scene::Mechanism& mechanism);

/// 6 x n, and where the point is.
struct BoundedJacobian {
  Eigen::MatrixXd value, bound;  ///< ours, and how far it may be from the exact numbers, proven
  Eigen::MatrixXd engine;        ///< how far from these an engine's may be
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< of the link, to world axes
  Eigen::Vector3d point = Eigen::Vector3d::Zero(),
                  origin = point;  ///< of the link; in the world [m]
};

/** The geometric Jacobian of a point of a link:

        J qd = (v, w)    velocity of the point [m/s], angular velocity of the link [rad/s]

    both against the world, in world axes, linear part first; columns in the order of the rates.
    Column j is found by the outward sweep of velocities at a unit rate j, with running error
    bounds. What an engine may lose is the larger of what two ways to it lose, by the sizes of their
    terms as EngineBound counts them (engine_bound.cpp, where both are computed): velocities link by
    link, and z_j x (p - p_j) of points of the world, whose common part need not cancel exactly. */
class FrameJacobian {
 public:
  explicit FrameJacobian(const PreparedScene& scene);
  ~FrameJacobian();

  BoundedJacobian operator()(const FramePoint& point, const scene::State<double>& state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Another thing that may be meant by the Jacobian of a frame, in words.
struct JacobianReading {
  std::string words;
  Eigen::MatrixXd value;
};
std::vector<JacobianReading> otherReadings(const BoundedJacobian& jacobian);

}  // namespace dynwitness::crosscheck
