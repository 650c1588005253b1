// SPDX-License-Identifier: GPL-3.0-or-later
// The mass and moments that the shape of a geom makes. For the reader of MJCF (mjcf_*.cpp) alone.
#pragma once

#include <optional>

#include "scene/mjcf_elements.hpp"
#include "scene/mjcf_orientations.hpp"
#include "scene/mjcf_settings.hpp"

namespace dynwitness::scene::mjcf {

/// Mass [kg], centre of mass and inertia about it, in axes turned by rpy.
struct Solid {
  Number mass;
  Vector com;
  Turn turn;
  Vector moments;  ///< principal, in these axes
};

/** Of a geom; none: it has no mass.
    @param rests     its body rests in the world: what it is made of does not matter
    @param is_known  false: a mesh makes it */
std::optional<Solid> solidOf(const Said& said, const Compiler& compiler, bool rests,
                             bool* is_known);

}  // namespace dynwitness::scene::mjcf
