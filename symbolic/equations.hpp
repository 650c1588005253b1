// SPDX-License-Identifier: GPL-3.0-or-later
// The equations of motion of a mechanism, derived from its kinetic and potential energy alone.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "symbolic/graph.hpp"
#include "symbolic/options.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::symbolic {

/// A joint whose rates are no derivatives of its positions.
struct QuasiJoint {
  std::string joint;
  bool floats;     ///< three velocities before the three angular velocities
  int rate, slot;  ///< first rate; first component of the quaternion
};

/** T, V and what follows from them; n = number of degrees of freedom, in the order of qd.

        p_i = dT/dqd_i                              momentum                                (1)
        M_ij = dp_i/dqd_j                           mass matrix                             (2)
        c_i = sum_j (dp_i/dq_j) qd_j - dT/dq_i      Coriolis and centrifugal forces         (3)
        g_i = dV/dq_i                               gravity and springs                     (4)
        Q_i = d(power of the constant wrenches)/dqd_i - dR/dqd_i                            (5)

    with Rayleigh's function R of friction (generalized_forces.hpp), so that

        M qdd + c + g = tau + Q

    Equation (3) is  c_i = sum_jk Gamma_ijk qd_j qd_k  with the Christoffel symbols of M.

    Where rates are quasi-velocities (quasi_velocities.hpp), the direction X_i in which rate i moves
    the state takes the place of d/dq_i, and (3) gets one term more (Boltzmann, Hamel),

        c_i = sum_j (X_j p_i) qd_j - X_i T + sum_jk b_ijk qd_j p_k                          (3')

    which for a body that turns about a fixed point is Euler's  dp/dt + w x p.

    A rotor that is geared to several rates (scene::Rotor) turns at  psi' = sum of n_k qd_k  and has
    a coordinate of its own: p contains  n_k dT/dpsi', but b_ijk takes p without that.

    A joint that follows another (scene::Mimic) has no rate: T and V are written with  qd = k
    qd_leader, and the leader's direction moves both positions, so that all above holds as it
    stands. */
struct Equations {
  Graph graph;
  std::vector<std::string> joints;  ///< names of the rates: that of the joint, or "joint.turn"
  std::vector<bool> revolute;       ///< of the same rates: turns (rad) or slides (m)
  /// For each joint the next revolute joint inboard when both turn about the same direction, so
  /// that their angles add up; otherwise -1.
  std::vector<int> parallel_inboard;
  std::vector<QuasiJoint> quasi;
  std::vector<Direction> directions;  ///< X_i of each rate
  /// Names of the links that joints carry. A joint that is treated as several in a row has a
  /// massless link after each but the last.
  std::vector<std::string> links;
  int positions = 0;  ///< how many there are, those of followers among them

  Node kinetic;    ///< T [J], from the velocities of the links
  Node potential;  ///< V [J], zero for masses at the world's origin and springs at rest
  std::vector<Node> link_kinetic;    ///< share of each moving link in T (its rotor's included)
  std::vector<Node> link_potential;  ///< share of each moving link in V (its spring's included)
  std::vector<Node> p, c, g, Q;
  std::vector<Node> gear_momenta;  ///< of p: n dT/dpsi' of rotors geared to several rates
  std::vector<Node> friction;      ///< dR/dqd, which Q contains with a minus sign
  std::vector<std::vector<Node>> M;

  int dof() const { return static_cast<int>(joints.size()); }
  bool hasFollowers() const { return positions != dof() + static_cast<int>(quasi.size()); }
};

/** Forms T and V of a mechanism with 3-D frames and velocities, and derives the rest. T is formed
    twice: from the velocities of the links, which suits (1) and (3), O(n) operations each; and from
    the composite bodies outboard of each joint, which suits (2). That both are the same function
    is a check of the derivation. */
Equations derive(const scene::Mechanism& mechanism, const Options& options = {});

/// T, V and p alone, and how rates move positions: enough for all that is a derivative of them.
Equations deriveEnergies(const scene::Mechanism& mechanism, const Options& options = {});
/// derive() without M, which alone takes more than O(n) operations: O(n^2) for a chain of n joints.
Equations deriveForces(const scene::Mechanism& mechanism, const Options& options = {});

/// All that inverseDynamics() takes: T, V, p and Q.
Equations deriveForInverseDynamics(const scene::Mechanism& mechanism, const Options& options = {});

/// Adds M to what deriveEnergies() or deriveForces() made of the same mechanism with the same
/// options.
void addMassMatrix(const scene::Mechanism& mechanism, const Options& options, Equations& equations);

/// Inverse dynamics without M: tau_i = dp_i/dt - dT/dq_i + dV/dq_i - Q_i, in O(n) operations (and
/// the last term of (3') where there are quasi-velocities).
std::vector<Node> inverseDynamics(Equations& equations);

/// M row by row, then c, then g: n (n + 2) outputs.
std::vector<Node> massCoriolisGravity(const Equations& equations);

}  // namespace dynwitness::symbolic
