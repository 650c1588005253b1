// SPDX-License-Identifier: GPL-3.0-or-later
// Joint reactions from Lagrange's equations with multipliers.
#pragma once

#include <vector>

#include "symbolic/closures.hpp"

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
  /// Along the rates u of the cuts, which are closed: how the equations of closures change (a row
  /// an equation), and the places of frames (twelve rows a frame, as frameEquations() has them).
  std::vector<std::vector<Node>> by_closure, by_frame;
};
Reactions reactions(const scene::Mechanism& mechanism, const Options& options = {});

/** The same with by_closure and by_frame: forces along these take lambda off the joints,

        reactions = lambda - by_closure' lambda_closures - by_frame' (forces on frames)

    @param frames  of links of `mechanism` */
Reactions reactionsAlong(const scene::Mechanism& mechanism, const Options& options,
                         const std::vector<scene::Attachment>& frames);

/// The mechanism with every link let go, and where its state is found in that of the whole.
struct Freed {
  scene::Mechanism mechanism;
  /// Of each rate and each position of the freed mechanism: its place in the given one, or -1 where
  /// it is one of a cut.
  std::vector<int> rate, slot;
  std::vector<int> link;  ///< by link of the given one: which it is there
};
/// Closures, springs and acceleration constraints go with their links.
Freed freed(const scene::Mechanism& mechanism);

}  // namespace dynwitness::symbolic
