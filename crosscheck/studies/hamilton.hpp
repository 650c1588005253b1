// SPDX-License-Identifier: GPL-3.0-or-later
// Hamilton's principle on a simulated motion: first and second variation of the action, conjugate
// times.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "crosscheck/verdicts/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct ActionOptions {
  double duration = 1;        ///< [s]
  std::vector<double> q, qd;  ///< start; empty: the scene's
  double damping = 0;         ///< of every joint, force -damping qd [N m s/rad, N s/m]
  bool potential = true;      ///< false: no gravity, springs, loads: geodesics of M
  int paths = 5;              ///< how many varied paths
  std::uint64_t seed = 1;
};

/** What was found. The motion is integrated in `steps` equal steps by a method of order 4, and
    integrals over it are Simpson's sums of the same order, so that what vanishes in truth falls as
    step^4. */
struct Action {
  int dof = 0, steps = 0;
  double duration = 0;       ///< [s]
  double action = 0;         ///< S = integral of T - V [J s]
  bool conservative = true;  ///< no loads, no dampers: only then are conjugate times looked for
  double energy_drift = 0;   ///< largest |E - E0| where conservative [J]

  /** A path q + eta with the same ends, eta at most of size `amplitude`: a sum of three sines a
      joint, drawn; the direction that lowers the action most, straight from node to node; a fast
      sine. unsure holds rounding (running bounds), by how much half as many steps change it, dS,
      which vanishes in truth, and what is no second variation. */
  struct Path {
    enum class Kind {
      kDrawn,    ///< at random
      kSlowest,  ///< in the direction that lowers the action most
      kFast,
    };
    struct Change {
      double value, unsure;  ///< [J s]
    };

    Kind kind = Kind::kDrawn;
    std::string name;
    double amplitude;               ///< [rad, m]
    double first = 0;               ///< left side of (1) below, for eta of amplitude 1 [J s]
    double change = 0, unsure = 0;  ///< S(q + eta) - S(q) lies within change +- unsure [J s]

    bool isSure() const { return std::abs(change) > unsure; }
    void put(const Change& found) {
      change = found.value;
      unsure = found.unsure;
    }
  };
  std::vector<Path> paths;
  /// Where Q is not 0: the largest first variation when its work is put into the Lagrangian, as
  /// integral of T - V + W, with W(t) the work done up to t [J s]; with half as many steps.
  double with_work = 0, with_work_coarse = 0;

  struct Conjugate {
    double time, error;  ///< [s]; error: change from half as many steps
    int multiplicity;
  };
  std::vector<Conjugate> conjugates;  ///< of the start, in (0, duration)
  int negative = -1;  ///< negative directions of the second variation; -1: not counted
  double lowest = 0;  ///< eigenvalue of the second variation over its kinetic part
  std::vector<CheckResult> checks;
};

/** Integrates the motion of a tree from its start, on the surface where its closures hold, and
    looks at the action of the paths near it, which stay on that surface.

        (1)  dS(eta) + integral of Q' eta dt = 0
             for every eta that vanishes at both ends: Hamilton's principle, and d'Alembert's and
             Lagrange's where Q != 0
        (2)  q(t) + eps J(t) is again a motion
             J solves the variational equation, here by the steps on duals. J(0) = 0, J'(0) = e_k
             for every k make a matrix A(t); a time t* with det A(t*) = 0 is conjugate
        (3)  the second variation of S on variations with fixed ends has as many negative
             directions as there are conjugate times in (0, duration) (Morse), here on variations
             that are straight from node to node

    (3) knows T and V alone, (2) the articulated-body sweep alone.

    What the steps or the rounding of the place leave undecided is not answerable.

    @throws scene::InputError  springs between points, closures of rates, drives and friction of the
                               scene, wrong sizes, duration not positive, velocities whose squares
                               have no digits, a start that has no qdd, a motion that leaves the
                               numbers in the shortest steps
    @see C. Lanczos, The Variational Principles of Mechanics (1970), chapter V;
         I. Gelfand, S. Fomin, Calculus of Variations (1963), sections 24 to 29 */
Action measureAction(const scene::Scene& scene, const ActionOptions& options);

}  // namespace dynwitness::crosscheck
