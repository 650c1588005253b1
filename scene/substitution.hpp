// SPDX-License-Identifier: GPL-3.0-or-later
// A mechanism in which parameters are put in: exact numbers, or expressions in the other ones.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"

namespace dynwitness::scene {

/** The mechanism with each named parameter replaced wherever it stands, as l by 1, m2 by 0 or l2
    by l1; what was replaced is a letter of it no more. Nothing is rounded.

    Unlike another value of the parameter (setNumber()) this asks for no body that could be: a
    derivation may have a mass of 0. What has no meaning at all is refused: a division by 0, an axis
    without a direction.
    @param words  "l=1", "l2=l1/2"
    @throws InputError  no such parameter (with the nearest), one twice, an expression in what is
      itself replaced, or none; what has no meaning then */
Mechanism substituted(const Mechanism& mechanism, const std::vector<std::string>& words);

}  // namespace dynwitness::scene
