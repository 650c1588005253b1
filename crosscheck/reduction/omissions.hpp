// SPDX-License-Identifier: GPL-3.0-or-later
// What a link can be without, for models that are smaller than the scene.
#pragma once

#include <cstddef>
#include <string>

#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/// One thing that a link, or the joint that carries it, can be without.
struct Omission {
  enum class What {
    kCom,       ///< one coordinate of its centre of mass
    kProducts,  ///< products of inertia about the centre of mass, in the axes that the file gives
    kInertia,   ///< all of the inertia about the centre of mass: it is a point there
    kOnAxis,    ///< all but a mass on the axis that the joint turns about
    kMass,      ///< mass and inertia
    kRotor,     ///< n^2 J of a rotor that is not gyroscopic
    kSpin,      ///< what the carrier feels of a gyroscopic rotor, whose n^2 J stays
    kFriction,
  };
  std::size_t link;
  What what;
  int axis = 0;  ///< of kCom: x, y, z
};

/// Takes it away. @return false: it was not there, and nothing is changed
bool apply(const Omission& omission, scene::Mechanism* mechanism);

/// "link_6: its products of inertia"
std::string words(const Omission& omission, const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
