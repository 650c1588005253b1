// SPDX-License-Identifier: GPL-3.0-or-later
// Mass and inertia of the bodies of an MJCF file. For the reader of MJCF (mjcf_*.cpp) alone.
#pragma once

#include <vector>

#include "scene/arrange.hpp"
#include "scene/mjcf_elements.hpp"
#include "scene/mjcf_settings.hpp"

namespace dynwitness::scene::mjcf {

/** Inertia is <inertial>, or made of shapes: where there is none (auto), or in any case (true).
    @param of_body   its class for what is in it
    @param rests     in the world
    @param is_known  false: it is made of meshes, of a body that rests in the world */
MassProperties readInertia(const Node& node, const Compiler& compiler, const Defaults& defaults,
                           const Class& of_body, bool rests, bool* is_known);

/// settotalmass: one factor for all masses and inertias.
void setTotalMass(const Compiler& compiler, std::vector<NamedLink>* links);

}  // namespace dynwitness::scene::mjcf
