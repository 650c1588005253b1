// SPDX-License-Identifier: GPL-3.0-or-later
// Kinematics that `evaluate` answers: where points of links are, and how they move.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/motion/joint_axes.hpp"
#include "crosscheck/witnesses/frame_jacobian.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** Of a point of a link, n the scene's rates:
      position       3: in world axes, from the world's origin [m]
      orientation    3 x 3: its columns are the link's axes in world axes
      quaternion     4: (w, x, y, z) of it, length 1, w >= 0
      rpy            3: roll, pitch, yaw of it, Rz(yaw) Ry(pitch) Rx(roll) [rad]
      velocity       6: of the point, and of the link's turn [m/s, rad/s]
      acceleration   6: of the point itself (not spatial), and of the turn; without gravity
      jacobian       6 x n: velocity = J qd
      jacobian_rate  6 x n: dJ/dt along qd, acceleration = J qdd + dJ/dt qd
    The last four are vectors as the world sees them, in world axes or turned into the link's. */
enum class PointQuantity {
  kPosition,
  kOrientation,
  kQuaternion,
  kRpy,
  kVelocity,
  kAcceleration,
  kJacobian,
  kJacobianRate
};
const char* name(PointQuantity quantity);
std::optional<PointQuantity> pointQuantityNamed(const std::string& name);
std::vector<std::string> pointQuantityNames();

/// By one sweep of the links that carry each point (recursive/point_motion.hpp).
class PointQuantities {
 public:
  /// @param points  none: the origins of all links but the root
  /// @throws std::invalid_argument  axes of joints, which points do not have
  PointQuantities(const scene::Scene& scene, const std::vector<FramePoint>& points, JointAxes axes);
  ~PointQuantities();

  /// "hand.position_x", "hand.orientation12", "hand.jacobian_vx_qd1", in the order of value();
  /// "hand#2" is the second point of a link.
  std::vector<std::string> columns(PointQuantity quantity) const;
  /// Their units, "m/s"; "1" where there is none.
  std::vector<std::string> units(PointQuantity quantity) const;

  /// @param state  qdd may be missing: then acceleration is that without it
  void at(const scene::State<double>& state);
  /// Of the state, row by row, one entry a column of columns().
  Eigen::VectorXd value(PointQuantity quantity) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
