// SPDX-License-Identifier: GPL-3.0-or-later
// Motion near a state: A, B, modes and what forces reach.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/scalars/bounded.hpp"
#include "crosscheck/scalars/enclosed_modes.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct LinearizationOptions {
  std::vector<double> q, qd;          ///< empty: the scene's start, rest
  bool seeks_equilibrium = false;     ///< q is a guess: where is it at rest without joint forces?
  bool has_no_forces = false;         ///< tau = 0; else the forces that make qdd 0 there
  std::vector<std::string> actuated;  ///< joints, by name; empty: all
};

enum class Stability { kStable, kUnstable, kUndecided };
/// "asymptotically stable", ...
const char* name(Stability stability);

/** d/dt (dq, dqd) = A (dq, dqd) + B dtau  near a state. dq is along the rates' axes: where these
    are no derivatives of coordinates, along body axes.

    Under closures and drives dq and dqd are those of some rates, on which the others depend
    (constrained_linearization.hpp): p positions and r rates, p = r where no closure is about rates
    alone. Otherwise p = r = n. */
struct Linearization {
  std::vector<double> q, qd;
  Bounded tau;  ///< n x 1: joint forces there, of driven joints what the drive takes
  Bounded qdd;  ///< n x 1: what they make; 0 where they hold it
  Bounded A;    ///< p + r square: [0 1; dqdd/dq dqdd/dqd] of a tree at rest
  Bounded B;    ///< p + r x m: [0; dqdd/dtau] of the actuated joints
  std::vector<int> positions, rates;  ///< that A is about
  Eigen::MatrixXd along;              ///< n x p: dq of all rates by those of A
  std::vector<int> actuated;          ///< rates, by column of B
  EnclosedModes modes;
  Stability stability = Stability::kUndecided;
  int reached = 0;     ///< dimension that the actuated joints' forces reach, at least, of 2n
  bool rests = false;  ///< it stays there: qd = 0, qdd = 0. Elsewhere A is that of the moment
  int newton_steps = 0;
  std::optional<CheckResult> by_lagrange;  ///< derivatives by the other road, of whole mechanisms
};

/// Rates that nobody gives: of driven joints their own at t = 0, of the others none.
std::vector<double> restingRates(const scene::Scene& scene);

/** Entries of A and B in balls of as many bits as that takes, rounded to double with what that
    leaves open; modes enclosed for everything within (enclosed_modes.hpp). Stability is that of the
    linearized motion where it rests, and decided where every enclosure is left of the axis, or one
    is right of it. Driven joints are where their motions put them at t = 0, q and qd are moved onto
    the closures.
    @throws scene::InputError  what Command::kLinearize refuses; sizes and names that do not fit;
      closures that no small change closes; no equilibrium found */
Linearization linearize(const scene::Scene& scene, const LinearizationOptions& options);

/** Of the tree, its joints free, over the field, for every state:
      M dqdd/dq = - dtau/dq,  M dqdd/dqd = - dtau/dqd     qdd by articulated bodies, M by composite
                                                          bodies, tau by Lagrange's equations
      M dqdd/dtau = 1
      dtau/dq, dtau/dqd                                   Newton and Euler = Lagrange
      dg/dq = (dg/dq)'                                    where there is a potential */
std::vector<CheckResult> checkLinearizationExactly(const scene::Scene& scene,
                                                   const ExactOptions& options);

}  // namespace dynwitness::crosscheck
