// SPDX-License-Identifier: GPL-3.0-or-later
// Orientations of MJCF files, in all five ways to say them. For the reader of MJCF (mjcf_*.cpp)
// alone.
#pragma once

#include "scene/mjcf_elements.hpp"
#include "scene/mjcf_numbers.hpp"
#include "scene/mjcf_settings.hpp"

namespace dynwitness::scene::mjcf {

/// A frame in the world where all joints are at their reference.
struct Pose {
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Zero();
};

/// An orientation: as a matrix, and in the scene's words.
struct Turn {
  Matrix3 R = Matrix3::Identity();
  Vector rpy;
  bool isNone() const { return isZero(rpy); }
};

/// Of quat, euler, axisangle, xyaxes or zaxis; none: no turn.
Turn turnSaid(const Said& said, const Compiler& compiler);

}  // namespace dynwitness::scene::mjcf
