// SPDX-License-Identifier: GPL-3.0-or-later
// How energies and joint forces depend on the inertial parameters: by differentiating the
// derivation.
#pragma once

#include <vector>

#include "scene/inertial_parameters.hpp"
#include "symbolic/equations.hpp"

namespace dynwitness::symbolic {

/** The equations of a mechanism with a symbol for each of its inertial parameters pi: masses m,
    centres of mass c, inertias about the link's origin and rotor inertias, whatever values the
    scene gives them. T and V are linear in pi (with h = m c), and so is all that follows. */
struct InertialSymbols {
  scene::Mechanism mechanism;  ///< with the symbols as parameters: m = 1, all others 0
  std::vector<scene::InertialParameter> parameters;
  Equations equations;
  std::vector<Node> symbols;  ///< one a parameter: m, c_x, c_y, c_z, Ixx, ..., rotor
};
InertialSymbols inertialSymbols(const scene::Mechanism& mechanism);

/** df/dpi_j for all parameters. The symbols are (m, c), the parameters (m, h):
        df/dh = (df/dc) / m,    df/dm = df/dm at constant c - sum_k c_k df/dh_k
    @param f  a node of the equations' graph */
std::vector<Node> byInertialParameters(InertialSymbols& symbols, Node f);

/** The regressor Y_ij = dtau_i/dpi_j [n x p] of  tau = dp/dt - dT/dq + dV/dq - Q: that of the terms
    linear in pi, without springs and loads. */
std::vector<std::vector<Node>> regressor(InertialSymbols& symbols);

/** sum_i w_i Y_ij for all j, for the price of one row of Y. The weights w are the joint forces of
    the state; where they may be any vector, this says as much as all of Y. */
std::vector<Node> weightedRegressor(InertialSymbols& symbols);

/// d(T + V)/dpi_j for all j.
std::vector<Node> energyRegressor(InertialSymbols& symbols);

}  // namespace dynwitness::symbolic
