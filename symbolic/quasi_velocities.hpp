// SPDX-License-Identifier: GPL-3.0-or-later
/* Differentiation along rates, which need not be derivatives of positions.

   Rates of spherical and floating joints are quasi-velocities: no positions have them as
   derivatives. What a rate does is a direction X_i,

       a turn of a body at w:  dR/dt = R [w]x      a shift at v:  dp/dt = R v
       X_i f = df/dt when rate i alone is 1, the others 0

   and takes the place of d/dq_i, which it is for all other joints. Two such directions do not
   commute: X_i X_j f - X_j X_i f = sum_k b_ijk X_k f, with the constants of turns and shifts:

       [turn_x, turn_y] = turn_z,   [turn_x, shift_y] = shift_z,   [shift_x, shift_y] = 0

   and so on in a circle. */
#pragma once

#include <vector>

#include "symbolic/equations.hpp"

namespace dynwitness::symbolic {

/// X_i f for all rates i.
std::vector<Node> positionGradient(Equations& equations, Node f);

/// Gamma_ijk = (X_k M_ij + X_j M_ik - X_i M_jk) / 2: the Christoffel symbol of the first kind of M,
/// where rates are derivatives of positions.
Node christoffelSymbol(Equations& equations, int i, int j, int k);
/// All of them, Gamma_ijk at (i n + j) n + k.
std::vector<Node> christoffelSymbols(Equations& equations);

/// The direction in which positions move at these rates: sum of X_i rates_i.
Direction positionsAlong(Equations& equations, const std::vector<Node>& rates);

/// The direction in which the state moves: sum of X_i qd_i; with qdd, the rates move too.
Direction motion(Equations& equations, bool with_accelerations = false);

/// sum_jk b_ijk qd_j p_k for all rates i: the term that Boltzmann and Hamel add to Lagrange's
/// equations.
std::vector<Node> structureTerms(Equations& equations, const std::vector<Node>& p);

/// That term in the equations of motion: of the momenta without what comes through gears, since
/// rotors have coordinates of their own (scene::Rotor).
std::vector<Node> hamelTerms(Equations& equations, std::vector<Node> p);

}  // namespace dynwitness::symbolic
