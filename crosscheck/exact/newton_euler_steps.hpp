// SPDX-License-Identifier: GPL-3.0-or-later
// The recursive Newton-Euler sweep written down beside a derivation, until both say the same line.
#pragma once

#include "symbolic/derivation.hpp"

namespace dynwitness::crosscheck {

/** Adds the steps of the sweep to a derivation in closed form: velocities and accelerations of the
    links outward, forces through the joints inward, and the joint forces, which are the left sides
    of Lagrange's equations. The sweep is recursive::inverseDynamics() itself, run on formulas,
    without friction and loads; it shares the scene's numbers with the derivation and no formula.
    Whether the lines are the same is decided by the normal form of their difference, for all values
    of parameters and state.
    @throws scene::InputError  the derivation has no closed form (more than three joints, rates that
      are no derivatives) */
void addNewtonEuler(symbolic::Derivation* derivation);

}  // namespace dynwitness::crosscheck
