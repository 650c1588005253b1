// SPDX-License-Identifier: GPL-3.0-or-later
// A derivation as somebody asked for it: some of its lines, other letters for q.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "symbolic/derivation.hpp"

namespace dynwitness::symbolic {

/** The equations of these names, each in its step, and the lines that they are made of; steps
    without any are left out.
    @param names  of what stands on the left ("M12", "T", "x_upper"), of a force for its equation of
      motion ("tau1"), or of all with an index ("M", "c", "Gamma", "tau")
    @throws scene::InputError  of a name that is none, with the nearest and those there are */
Derivation only(const Derivation& derivation, const std::vector<std::string>& names);

/// The same for the equations of the steps that lead to a quantity: "M", "c", "g".
Derivation onlyQuantity(const Derivation& derivation, const std::string& quantity);

/** Other names for positions, and for their rates with them: q1 as theta makes qd1 theta_dot,
    in LaTeX and MathML theta with a dot.
    @param names  ("q1", "theta"): names that a parameter may have, and nothing else has
    @throws scene::InputError  a position that there is not (with the nearest), or is a component of
      a quaternion, which no formula shows; a name that another thing has, as it is printed */
Derivation renamed(const Derivation& derivation,
                   const std::vector<std::pair<std::string, std::string>>& names);

/** Cosines and sines of sums of positions under short names: c12 is cos(q1 + q2), s2m4
    sin(q2 - q4), c22 cos(2 q2). The first step says which there are. A name that means something
    else (the force c12 of a twelfth joint, a parameter) is left to that, and the angle written
    out. */
Derivation withShorthand(Derivation derivation);

}  // namespace dynwitness::symbolic
