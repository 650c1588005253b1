// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences between formulas: what is mathematics in them is set as such.
#pragma once

#include <string>

#include "symbolic/formula.hpp"

namespace dynwitness::symbolic {

/** A sentence of a derivation in a notation, in which words such as dM_ij, qd_j, Gamma112, omega or
    a single letter are mathematics: in LaTeX $dM_{ij}$, $\dot{q}_{j}$, ..., in MathML `math`
    elements without attributes. The
    rest is escaped as by printText(). */
std::string printSentence(const std::string& sentence, Style style);

}  // namespace dynwitness::symbolic
