// SPDX-License-Identifier: GPL-3.0-or-later
// Joint reactions from Lagrange's equations with multipliers.
#pragma once

#include <vector>

#include "symbolic/equations.hpp"

namespace dynwitness::symbolic {

/** What every joint transmits, by cutting it: 6 numbers a link but the root, force then moment.

    Each link is let go of its moved joint frame: between the two comes a free joint, with six rates
    u (velocity of the origin, angular velocity, in the axes of that frame) besides the joint's own.
    The real motion has u = 0, du/dt = 0 and no displacement. The constraint u = 0 has a multiplier
    for each of the six, and the equations of the freed mechanism (Lagrange's, with Boltzmann's and
    Hamel's term) say what it is where the constraint holds:

        lambda_k = d/dt (dT/du_k) + sum_jl b_kjl u_j p_l - X_k (T - V) - Q_k     at u = 0

    Its power is lambda' u: that of the wrench which holds the link on its moved joint frame, and
    acts on the link. The joint's own equation says what of it is tau.

    The outputs read the position, velocity and acceleration of `mechanism`.
    @see scene::Joint for what counts as the parent's (gyroscopic rotors), Witness::answer for the
         axes */
struct Reactions {
  Graph graph;
  std::vector<Node> lambda;
};
Reactions reactions(const scene::Mechanism& mechanism, const Options& options = {});

}  // namespace dynwitness::symbolic
