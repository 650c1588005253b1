// SPDX-License-Identifier: GPL-3.0-or-later
// Forces without potential, as functions of the rates whose derivatives by qd are their share of Q.
#pragma once

#include "symbolic/bodies.hpp"

namespace dynwitness::symbolic {

/// sum of f' v_at + m' w over the constant wrenches [W].
Value wrenchPower(BodyTree& tree);

/** Rayleigh's function of the joints' friction [W]: its derivative by qd is what friction takes of
    tau.
        R = sum (viscous qd^2 / 2 + coulomb(sign qd) qd),  the sign being a constant of its own */
Value dissipation(BodyTree& tree);

}  // namespace dynwitness::symbolic
