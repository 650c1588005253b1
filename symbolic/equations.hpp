// SPDX-License-Identifier: GPL-3.0-or-later
// The equations of motion of a mechanism, derived from its kinetic and potential energy alone.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"
#include "symbolic/graph.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::symbolic {

struct Options {
  /// Parameters become their exact values. Otherwise they stay symbols, and the derivation speaks
  /// in the scene's own letters.
  bool fold_parameters = false;
  /// Moves to the inboard link what a joint's axis cannot tell apart (mass, first moment along the
  /// axis, one moment of inertia), so that T needs fewer operations. The energies stay the same
  /// functions; the share of each link does not.
  bool regroup_inertias = true;
};

/// How one rate moves the state: the direction (dx/dt of each variable) that it alone gives.
using Direction = std::vector<std::pair<Variable, Node>>;

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

    with Rayleigh's function R of friction (Lagrangian::dissipation), so that  M qdd + c + g = tau +
    Q. Equation (3) is  sum_jk Gamma_ijk qd_j qd_k  with the Christoffel symbols of M;
    christoffelMatrix() gives them their matrix.

    Rates of spherical and floating joints are quasi-velocities: no positions have them as
    derivatives. What a rate does is then a direction X_i,

        a turn of a body at w:  dR/dt = R [w]x      a shift at v:  dp/dt = R v
        X_i f = df/dt when rate i alone is 1, the others 0

    and d/dq_i above is X_i. Two such directions do not commute, X_i X_j f - X_j X_i f = sum_k b_ijk
    X_k f with the constants of turns and shifts, [turn_x, turn_y] = turn_z, [turn_x, shift_y] =
    shift_z and so on in a circle (shifts commute). Equation (3) gets one term more (Boltzmann,
    Hamel):

        c_i = sum_j (X_j p_i) qd_j - X_i T + sum_jk b_ijk qd_j p_k                              (3')

    which for a body that turns about a fixed point is Euler's  dp/dt + w x p.

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
  std::vector<QuasiJoint> quasi;      ///< joints with quasi-velocities
  std::vector<Direction> directions;  ///< X_i of each rate
  std::vector<std::string>
      links;  ///< names of the links that joints carry; a joint that is treated
              ///< as several in a row has a massless link after each but the last

  Node kinetic;    ///< T [J], from the velocities of the links
  Node potential;  ///< V [J], zero for masses at the world's origin and springs at rest
  std::vector<Node> link_kinetic;    ///< share of each moving link in T (its rotor's included)
  std::vector<Node> link_potential;  ///< share of each moving link in V (its spring's included)
  std::vector<Node> p, c, g, Q;
  std::vector<Node> friction;  ///< dR/dqd, which Q contains with a minus sign
  std::vector<std::vector<Node>> M;

  int dof() const { return static_cast<int>(joints.size()); }
  int slots = 0;  ///< how many positions there are, those of followers among them
  int positions() const { return slots; }
  bool hasFollowers() const { return slots != dof() + static_cast<int>(quasi.size()); }
};

/** Forms T and V of a mechanism with 3-D frames and velocities, and derives the rest. T is formed
    twice: from the velocities of the links, which suits (1) and (3), O(n) operations each; and from
    the composite bodies outboard of each joint, which suits (2). That both are the same function
    is a check of the derivation. */
Equations derive(const scene::Mechanism& mechanism, const Options& options = {});

/// derive() without M, which alone takes more than O(n) operations: O(n^2) for a chain of n joints.
Equations deriveForces(const scene::Mechanism& mechanism, const Options& options = {});
/// The energies and g alone, which takes half as many operations.
Equations deriveGravity(const scene::Mechanism& mechanism, const Options& options = {});
/// Adds M to what deriveForces() made of the same mechanism with the same options.
void addMassMatrix(const scene::Mechanism& mechanism, const Options& options, Equations& equations);

/// X_i f for all rates i.
std::vector<Node> positionGradient(Equations& equations, Node f);
/// The direction in which the state moves: sum of X_i qd_i; with qdd, the rates move too.
Direction motion(Equations& equations, bool with_accelerations = false);
/// sum_jk b_ijk qd_j p_k for all rates i, the last term of (3').
std::vector<Node> structureTerms(Equations& equations, const std::vector<Node>& p);
/** The closures of a mechanism and their derivatives, for Lagrange's equations with multipliers

        M qdd + c + g = tau + Q + J' lambda,    J qdd + gamma = 0                           (6)

    phi [m], J_ki = X_i phi_k [m x n] (dphi_k/dq_i, or along the rate where there are
    quasi-velocities), gamma = (dJ/dt) qd [m]; their order is that of scene::Closure. */
struct ClosureEquations {
  std::vector<Node> phi, gamma;
  std::vector<std::vector<Node>> J;
};

/// Adds the closures to the graph of `equations`, which derive() made of the same mechanism with
/// the same options: phi from the places of the frames in the world, the rest by differentiating
/// it.
ClosureEquations closureEquations(const scene::Mechanism& mechanism, const Options& options,
                                  Equations& equations);

/// The same for the places of frames in the world: twelve functions a frame, the components of its
/// origin and of its x, y and z axis.
ClosureEquations frameEquations(const scene::Mechanism& mechanism, const Options& options,
                                const std::vector<scene::Attachment>& frames, Equations& equations);

/** The Christoffel form of the Coriolis matrix [n x n], with  c = C qd  and  dM/dt - 2 C  skew:
        C_ij = sum_k Gamma_ijk qd_k = (dM_ij/dt + dp_i/dq_j - dp_j/dq_i) / 2
    and, with quasi-velocities, sum_k b_ijk p_k besides, which is skew. */
std::vector<std::vector<Node>> christoffelMatrix(Equations& equations);

/// Inverse dynamics without M: tau_i = dp_i/dt - dT/dq_i + dV/dq_i - Q_i, in O(n) operations (and
/// the last term of (3') where there are quasi-velocities).
std::vector<Node> inverseDynamics(Equations& equations);

/// M row by row, then c, then g: n (n + 2) outputs.
std::vector<Node> massCoriolisGravity(const Equations& equations);

}  // namespace dynwitness::symbolic
