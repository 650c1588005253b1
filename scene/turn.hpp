// SPDX-License-Identifier: GPL-3.0-or-later
// Turns about coordinate axes, for readers, writers and pictures. Who computes motion or judges
// what was read has one of its own.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "scene/numbers.hpp"

namespace dynwitness::scene {

/// R of x' = R x for a turn about axis 0, 1 or 2 (x, y, z) by the angle with this cosine and sine.
template <typename T>
Eigen::Matrix<T, 3, 3> turnAbout(int axis, const CosSin<T>& angle) {
  const int y = (axis + 1) % 3, z = (axis + 2) % 3;
  Eigen::Matrix<T, 3, 3> R = Eigen::Matrix<T, 3, 3>::Identity();
  R(y, y) = R(z, z) = angle.c;
  R(z, y) = angle.s;
  R(y, z) = -angle.s;
  return R;
}

/** Roll, pitch and yaw of R = Rz(yaw) Ry(pitch) Rx(roll). Roll is read off Rz(-yaw) R, so the three
    give R again also where the pitch is a right angle and yaw alone is undetermined.
    @param atan  atan(y, x): the angle of that point, whatever rounding has left of its zeros */
template <typename T, typename Atan>
Eigen::Matrix<T, 3, 1> rollPitchYaw(const Eigen::Matrix<T, 3, 3>& R, const Atan& atan) {
  using std::cos;
  using std::sin;
  const T yaw = atan(R(1, 0), R(0, 0)), c = cos(yaw), s = sin(yaw);
  const T pitch = atan(T(-R(2, 0)), T(c * R(0, 0) + s * R(1, 0)));
  const T roll = atan(T(s * R(0, 2) - c * R(1, 2)), T(c * R(1, 1) - s * R(0, 1)));
  return {roll, pitch, yaw};
}

}  // namespace dynwitness::scene
