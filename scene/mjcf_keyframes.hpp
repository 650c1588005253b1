// SPDX-License-Identifier: GPL-3.0-or-later
// The start of a scene, from the keyframes of an MJCF file. For the reader of MJCF (mjcf_*.cpp)
// alone.
#pragma once

#include "scene/mjcf_bodies.hpp"
#include "scene/mjcf_equality.hpp"
#include "scene/scene.hpp"

namespace dynwitness::scene::mjcf {

/// The first one is the start. MuJoCo's speeds of a free joint are in the axes of the world.
void readKeyframes(const Node& node, const Bodies& bodies, const Equalities& equalities,
                   Scene* scene, LeftOut* left_out);

}  // namespace dynwitness::scene::mjcf
