// SPDX-License-Identifier: GPL-3.0-or-later
// Impulses: the jump of velocity that they cause, what it does to momentum and energy, and impacts.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct ImpulseOptions {
  std::vector<double> q, qd;                ///< before; empty: the scene's start
  std::string link;                         ///< what is struck; empty: the last link
  std::array<double, 3> at{};               ///< where, in the link's frame [m]
  std::array<double, 3> force{}, moment{};  ///< impulses, world axes [N s], [N m s]
  std::vector<double> joints;               ///< impulses of the joints, n [N m s, N s]; empty: none
  std::array<double, 3> direction{};  ///< not 0: an impact on a wall with this normal, world axes
  double restitution = 0;             ///< of the impact: 0 plastic, 1 elastic
};

/// What happened, with running error bounds beside.
struct ImpulseResult {
  std::vector<double> before, after, after_bound;       ///< qd [rad/s, m/s]
  std::array<double, 3> point_before{}, point_after{};  ///< velocity of the point, world axes [m/s]
  std::array<double, 6> impulse{};  ///< at the point; of an impact, what the wall gave
  std::vector<double> closures;     ///< impulses of the closures' chosen equations
  int equations = 0;                ///< how many there are, redundant ones too
  std::array<double, 6> momentum_jump{}, support{};  ///< of all links; from the world's joints
  double energy_before = 0, energy_after = 0;        ///< kinetic [J]
  double effective_mass = 0;                         ///< of an impact: 1 / (n' J M^-1 J' n) [kg]
  std::vector<CheckResult> checks;
};

/** Forces so short and strong that nothing moves while they act:

        [ M  -J_c' ] [ qd+ - qd- ]   [ J' p + j ]
        [ J_c   0  ] [  Lambda   ] = [ -J_c qd- ]

    (p: impulse and its moment at the point, j: the joints'), so that afterwards closures hold their
    velocities too. An impact seeks p = n s with
    n' v+ = -restitution n' v- for the point's velocity v.
    @throws scene::InputError  sizes, names, or an impact of a point that does not move towards
                               anything */
ImpulseResult strike(const scene::Scene& scene, const ImpulseOptions& options);

/** The laws of impulses, over the field for every state and impulse:
      qd+ - qd- is what the articulated bodies accelerate by under J' p + j (open trees)
      T+ - T-   = p' (v+ + v-)/2 + j' (qd+ + qd-)/2
      the momentum of all links (4 x 4 matrices) jumps by p and by what the joints pass on to the
      world
      every joint passes on the impulse j - d (qd+ - qd-) along its axis
      an impact takes  (1 - e^2)/2 m (n' v-)^2,  m being the effective mass
      J_c qd+ = 0 */
std::vector<CheckResult> checkImpulsesExactly(const scene::Scene& scene, const std::string& link,
                                              const ExactOptions& options);

}  // namespace dynwitness::crosscheck
