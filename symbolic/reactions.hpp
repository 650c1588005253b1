// SPDX-License-Identifier: GPL-3.0-or-later
// Joint reactions from Lagrange's equations with multipliers.
#pragma once

#include <vector>

#include "symbolic/equations.hpp"

namespace dynwitness::symbolic {

/** What every joint transmits: six numbers for each link but the root, force then moment.

    Every joint is cut. Between the frame that it moves and the link that it carries, we put a free
    joint with six rates u (velocity of the origin and angular velocity, in the axes of that frame).
    In the real motion the cuts stay closed: u = 0, du/dt = 0, and no displacement. Each of the six
    constraints u_k = 0 has a multiplier, and Lagrange's equations of the freed mechanism (with
    Boltzmann's and Hamel's term) give it:

        lambda_k = d/dt (dT/du_k) + sum_jl b_kjl u_j p_l - X_k (T - V) - Q_k     at u = 0

    lambda' u is the power of the wrench that acts on the link and holds it on its joint. How much
    of that wrench is tau, the joint's own equation says.

    The outputs are functions of the position, velocity and acceleration of `mechanism`.
    @see scene::Joint for what counts as the parent's (gyroscopic rotors), Witness::answer for the
         axes */
struct Reactions {
  Graph graph;
  std::vector<Node> lambda;
};
Reactions reactions(const scene::Mechanism& mechanism, const Options& options = {});

}  // namespace dynwitness::symbolic
