// SPDX-License-Identifier: GPL-3.0-or-later
// Kinetic and potential energy of a tree of bodies, each formed in two ways.
//
// T from the velocities of the bodies takes O(n) operations and suits what is differentiated once;
// T from composite bodies suits M. V from composite first moments takes O(n) operations; V body by
// body is for readers.
#pragma once

#include <vector>

#include "symbolic/bodies.hpp"

namespace dynwitness::symbolic {

/// Shares of the bodies in T = sum (m v'v / 2 + (v x w)' first + w' second w / 2) + rotor qd^2/2
/// + spin qd (angular velocity of the parent about the axis), and of a rotor geared to several
/// rates J psi'^2/2 + J psi' (angular velocity of its carrier about its axis).
std::vector<Value> kineticByVelocities(const BodyTree& tree);

/// By rate: what of p = dT/dqd comes through the gears of geared rotors, n dT/dpsi'.
std::vector<Value> gearMomenta(const BodyTree& tree, int rates);

/** T once more, as a sum over joints instead of bodies: with h the momentum that the bodies
    outboard of joint i would have if body i rested, and I_i their composite moments of mass,
        T = sum_i (qd_i^2 s_i' I_i s_i / 2 + qd_i s_i' h_i). */
Value kineticByCompositeBodies(const BodyTree& tree);

/// V = -gravity' (integral of r dm) + sum stiffness (q - rest)^2 / 2, with the first moments of
/// mass gathered from the tips inward.
Value potential(const BodyTree& tree);

/// Shares of the bodies in V: the first moment of each is carried to the world by itself.
std::vector<Value> potentialByBody(const BodyTree& tree);

}  // namespace dynwitness::symbolic
