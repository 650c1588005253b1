// SPDX-License-Identifier: GPL-3.0-or-later
// Entries of M, c and g that are zero in every state, and why.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "crosscheck/verdicts/ledger.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct EquationZeros {
  std::vector<Ledger::Zeros> of;      ///< M, c, c_ijk, g
  double error_probability = 0;       ///< chance at most that an entry called zero is not
  std::vector<std::string> disputes;  ///< rules that contradict what was computed
};

/** Zero entries of the scene's tree, decided over the prime field: an entry that is zero at so many
    random points is zero as a formula.

    Reasons are rules about axes and masses, asked at the same points and of all entries, those that
    are not zero too: a rule that would explain one of these is wrong (`disputes`). Rules about axes
    alone hold whatever the links weigh, and those about masses do not: both are held against the
    same entry of a mechanism whose links have random masses, moments and inertias. With z the axes,
    gamma gravity, W what joint j carries, with i inboard of j:

        M_ij  different branches; two slides, z_i z_j = 0; a slide along the axis of a turn;
              W weighs nothing; j turns, and its momentum W S_j lies in a plane across z_j in which
              z_i lies (everywhere so where W is balanced about z_j; then no slide feels it either);
              j slides, and the centre of mass of W moves in a plane with axis i
        c_i   M does not depend on q; p_i = M_i. qd and T do not depend on q and q_i; all c_ijk
        c_ijk the three derivatives of M in Christoffel's symbol are zero, or cancel
        g_i   no gravity; gamma along the axis of a turn, across a slide; W weighs nothing, or its
              centre of mass is on the axis

    Joints that follow others and rotors geared to several rates have zeros and no rules; rules of c
    want rates that are derivatives of positions.
    @param error_probability  of all entries together */
EquationZeros equationZeros(const scene::Scene& scene, std::uint64_t seed,
                            double error_probability);

}  // namespace dynwitness::crosscheck
