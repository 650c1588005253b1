// SPDX-License-Identifier: GPL-3.0-or-later
// Joints that an envelope does not let move.
#pragma once

#include <string>
#include <vector>

#include "scene/envelope.hpp"

namespace dynwitness::scene {

/** The scene with each joint fixed whose q, qd and qdd are all [0, 0] in the envelope, and the
    ranges of the others: what is held at rest is no part of the motion, and its force is not asked
    about. Its rotor, spring and friction go with it.
    @param ranges  one a rate; those of the held ones are taken out
    @return names of the held joints; all joints are held: the scene stays as it is, and none */
std::vector<std::string> fixHeldJoints(Scene* scene, std::vector<JointRanges>* ranges);

}  // namespace dynwitness::scene
