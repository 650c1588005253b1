// SPDX-License-Identifier: GPL-3.0-or-later
// Energy along simulated motion.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct DriftOptions {
  double duration = 10;        ///< [s]
  std::vector<double> steps;   ///< [s], falling; empty: 0.01 s halved until the order shows
  std::string method = "runge_kutta4";
};

/// Fixed-step integrators of Boost.odeint: name and order.
std::vector<std::pair<std::string, int>> driftMethods();

/** Simulates the scene from its start state with the articulated-body sweep, no joint forces, and
    follows E = T + V; with viscous friction, what it has taken, the integral of its power, is added.
    Scenes with loads are refused, for their energy is not constant, and those with Coulomb friction, whose
    jumps cost every integrator its order.
    @return without paths where M is singular at the start state, so that no motion follows
    @throws scene::InputError for an unknown method, a step that is not positive, loads or Coulomb friction */
Drift measureDrift(const scene::Scene& scene, const DriftOptions& options);

/// Why a Drift has no paths.
inline constexpr const char* kNoMotion = "qdd has no value at the start state: M is singular there";

/// True when E = T + V of the tree (and what viscous friction has taken) must stay constant: no loads,
/// Coulomb friction, closures, or springs between points.
bool conservesEnergy(const scene::Mechanism& mechanism);

/** The verdict on a drift: with a correct qdd an integrator of order p loses energy as step^p, so the
    observed order must come out above p - 1. A wrong qdd drifts by the same amount at every step, an
    order of 0. */
CheckResult checkDrift(const Drift& drift);

}  // namespace dynwitness::crosscheck
