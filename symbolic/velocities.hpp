// SPDX-License-Identifier: GPL-3.0-or-later
// Velocities of the bodies, from the world outward.
#pragma once

#include <vector>

#include "symbolic/bodies.hpp"
#include "symbolic/vectors.hpp"

namespace dynwitness::symbolic {

/// Of a body, in its axes.
struct Velocity {
  Vector3 angular;  ///< [rad/s]
  Vector3 linear;   ///< of the origin [m/s]
  Value inboard;    ///< angular velocity of the parent about the axis of a joint of one rate
};

/// One a body; in the graph the components are called omega1x, v1x, ...
std::vector<Velocity> velocities(const BodyTree& tree);

}  // namespace dynwitness::symbolic
