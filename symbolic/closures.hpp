// SPDX-License-Identifier: GPL-3.0-or-later
// Loop closures: conditions between places of frames in the world, and their derivatives.
#pragma once

#include <vector>

#include "scene/mechanism.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/options.hpp"

namespace dynwitness::symbolic {

/** The closures of a mechanism and their derivatives, for Lagrange's equations with multipliers

        M qdd + c + g = tau + Q + J' lambda,    J qdd + gamma = 0

    phi [m], J_ki = X_i phi_k [m x n] (dphi_k/dq_i, or along the rate where there are
    quasi-velocities), gamma = (dJ/dt) qd [m]; their order is that of scene::Closure. Where an
    equation is one of rates, psi_k(q, qd) = 0 linear in qd (scene::isOfRates), phi_k = 0 and J_ki =
    dpsi_k/dqd_i, as d'Alembert and Lagrange have it. */
struct ClosureEquations {
  std::vector<Node> phi, gamma;
  std::vector<std::vector<Node>> J;
};

/** Adds the closures to the graph of `equations`, which derive() made of the same mechanism with
    the same options: phi as scene::Closure has it, from the places of both frames in the world,
    the rest by differentiating it.
    @param with_gamma  false leaves gamma empty */
ClosureEquations closureEquations(const scene::Mechanism& mechanism, const Options& options,
                                  Equations& equations, bool with_gamma = true);

/// The same for the places of frames in the world: twelve functions a frame, the components of its
/// origin and of its x, y and z axis.
ClosureEquations frameEquations(const scene::Mechanism& mechanism, const Options& options,
                                const std::vector<scene::Attachment>& frames, Equations& equations,
                                bool with_gamma = true);

}  // namespace dynwitness::symbolic
