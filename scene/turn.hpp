// SPDX-License-Identifier: GPL-3.0-or-later
// A turn about a coordinate axis, for readers, writers and pictures. Who computes motion or judges
// what was read has one of its own.
#pragma once

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

}  // namespace dynwitness::scene
