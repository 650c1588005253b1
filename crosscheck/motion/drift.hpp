// SPDX-License-Identifier: GPL-3.0-or-later
// Energy along simulated motion.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct DriftOptions {
  double duration = 10;       ///< [s]
  std::vector<double> steps;  ///< [s], falling; empty: 0.01 s halved until the order shows
  std::string method = "runge_kutta4";
  /// Whose qdd moves the scene, nullptr: its own. With another's, the energy is found to drift.
  const scene::Mechanism* moved_by = nullptr;
};

/// Fixed-step integrators of Boost.odeint: name and order.
std::vector<std::pair<std::string, int>> driftMethods();

/** Simulates the scene from its start state with the articulated-body sweep, no joint forces, and
    follows E = T + V; with viscous friction, what it has taken, the integral of its power, is
    added. A path ends where it leaves the numbers; its `worst` is not finite then.
    @return without paths where M is singular at the start state, so that no motion follows
    @throws scene::InputError for an unknown method, a step that is not positive, and what
            Command::kDrift refuses: scenes whose energy is not constant, or jumps */
Drift measureDrift(const scene::Scene& scene, const DriftOptions& options);

/// Why a Drift has no paths.
inline constexpr const char* kNoMotion = "qdd has no value at the start state: M is singular there";

/// Whether the order of the method shows between the two finest steps, or nothing is lost but
/// rounding.
bool isResolved(const Drift& drift);

/// Takes out the paths that left the numbers: they have nothing to show.
void eraseLostPaths(Drift& drift);

/** The verdict on a drift: with a correct qdd an integrator of order p loses energy as step^p, so
    the observed order must come out above p - 1. A wrong qdd drifts by the same amount at every
    step, an order of 0. So do steps that are too long for a stiff motion: where the order does not
    show, steps that adapt decide whether qdd is to blame, and the statement or the reason says what
    both found.
    @param options  those of the drift */
CheckResult checkDrift(const scene::Scene& scene, const Drift& drift,
                       const DriftOptions& options = {});

}  // namespace dynwitness::crosscheck
