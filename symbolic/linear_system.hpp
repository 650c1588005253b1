// SPDX-License-Identifier: GPL-3.0-or-later
// Motion near a state in letters: A and B of d/dt (dq, dqd) = A (dq, dqd) + B dtau.
#pragma once

#include <optional>
#include <vector>

#include "symbolic/derivation.hpp"

namespace dynwitness::symbolic {

/** What of a state is put in, exactly. What is not stays a letter: q_k, qd_k, qdd_k. */
struct PutIn {
  /// Of each position: the right angles [pi/2] that it is, 0 where it slides. An angle other than 0
  /// stays a letter where it stands outside of cosines and sines (springs).
  std::vector<std::optional<int>> right_angles;
  std::vector<bool> is_still;    ///< of each rate: qd_k = 0
  bool is_unaccelerated = true;  ///< qdd = 0

  bool isStill(int rate) const { return is_still[static_cast<std::size_t>(rate)]; }
};

/** What of a state can be put in: rates that are 0, slides that are 0, and angles that are no
    further than `near` from a whole number of right angles.
    @param near  [rad, m]; less than an ulp: an ulp, which a right angle is off that was typed */
PutIn putIn(const scene::Mechanism& mechanism, const std::vector<double>& q,
            const std::vector<double>& qd, bool is_unaccelerated, double near = 0);

/** tau [N m, N], M [kg m^2, kg], K [N m/rad, N/m], D [N m s/rad, N s/m], n x n, A, 2n x 2n, and B,
    2n x joints that are actuated. From the graph's derivatives of inverse dynamics and of T

        K_ij = d tau_i / dq_j,  D_ij = d tau_i / dqd_j     tau = M qdd + c + g - Q
        A = [0, 1; -M^-1 K, -M^-1 D],  B = [0; M^-1]

    with M^-1 by cofactors. */
struct LinearSystem {
  Derivation derivation;  ///< the steps: joint forces, M, K and D, A and B
  PutIn at;
  using Matrix = std::vector<std::vector<Node>>;  ///< of derivation.equations
  Matrix by_position, by_rate, by_force;          ///< n x n: -M^-1 K, -M^-1 D, M^-1
  bool is_forceless = false;                      ///< tau is 0 there, whatever the letters are
};

/** @param actuated  rates whose joint forces are columns of B
    @throws std::invalid_argument  a mechanism without closed forms
    @throws std::domain_error  M is singular there, whatever the letters are */
LinearSystem linearSystem(const scene::Mechanism& mechanism, const PutIn& at,
                          const std::vector<int>& actuated);

}  // namespace dynwitness::symbolic
