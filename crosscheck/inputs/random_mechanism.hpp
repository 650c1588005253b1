// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanisms that nobody chose: seeded random trees.
#pragma once

#include <cstdint>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// kPlain: fixed, revolute and prismatic joints, and no gyroscopic rotors: what every engine
/// builds.
enum class JointKinds { kAll, kPlain };

/** A random tree: a pure function of (seed, index, max_joints, kinds), and a valid scene.

    It has 1 to max_joints moving joints, each number equally likely, and links on fixed joints
    beside them; every joint kind and placement convention, general axes and angles, rotors with
    gears, springs, joints that follow others, gravity in any direction (or none), and loads in link
    and world axes. Inertias are those of a few point masses, so they are physical, down to rods and
    single points. All numbers are rational, or rational multiples of pi where they are angles.

    @param max_joints  at least 1
    @throws std::invalid_argument when max_joints < 1
    @see scene::writeSceneToml(), which makes a scene file of it */
scene::Scene randomScene(std::uint64_t seed, std::uint64_t index, int max_joints,
                         JointKinds kinds = JointKinds::kAll);
/** The tree of randomScene(), and by streams of their own what makes it more than a tree: springs
    and dampers between points, driven joints, and closures or acceleration constraints.

    A closure joins a link of the tree, or the root, with a body of its own that floats on another
    link, so that its equations are independent wherever that body is; the scene starts where they
    are satisfied but for rounding. Only what can be compared by sweeps is drawn: in a mechanism
    whose joints follow others springs alone, and no closures together with acceleration constraints
    (CONTRIBUTING, "Add a feature of mechanisms").

    @param max_joints  of the tree; bodies of closures come besides */
scene::Scene randomWholeScene(std::uint64_t seed, std::uint64_t index, int max_joints);
/// The tree with joints that follow others let go, for what knows trees of independent joints only.
scene::Scene randomTreeScene(std::uint64_t seed, std::uint64_t index, int max_joints);

}  // namespace dynwitness::crosscheck
