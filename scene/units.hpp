// SPDX-License-Identifier: GPL-3.0-or-later
// In what the positions, rates and forces of a joint are counted.
#pragma once

#include <cstddef>

#include "scene/mechanism.hpp"

namespace dynwitness::scene {

/// "rad", "m"; "1" of a component of a quaternion.
const char* unitOf(SlotKind slot);
/// Whether a rate of the joint is a velocity [m/s], and its force one [N]; otherwise they turn
/// [rad/s], [N m].
bool slides(JointKind kind, std::size_t rate);

}  // namespace dynwitness::scene
