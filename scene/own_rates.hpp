// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanisms whose rates belong together, as trees of joints with rates of their own.
#pragma once

#include <string>

#include "scene/mechanism.hpp"

namespace dynwitness::scene {

/** The mechanism with all followers let go and every geared rotor (Rotor) a link of its own, on a
    revolute joint: after all other links, so that their slots and rates come last. Witnesses of
    trees answer for it, and gears couple its rates.

    A rotor that is not gyroscopic turns in the world, a disc of 1 kg about its origin. A gyroscopic
    one turns about its axis on the link that carries it, without mass, and a link that is fixed
    there lacks as much: -J about the same axis, which is no body's.
    @throws InputError  hasNoTree() says why */
Mechanism withOwnRates(const Mechanism& mechanism);

/// Whether a link of that tree has less than no inertia.
bool hasLackingLinks(const Mechanism& mechanism);

/// Whether a gyroscopic rotor is on a link that fixed joints hold in the world: in that tree it
/// turns in the world, and these joints do not feel it.
bool hasRotorsHeldAtRest(const Mechanism& mechanism);

/// Why there is no such tree: a gyroscopic rotor whose axis is none of the joint frame's, so that
/// its inertia in that frame is no rational number. Empty: there is one.
std::string hasNoTree(const Mechanism& mechanism);

}  // namespace dynwitness::scene
