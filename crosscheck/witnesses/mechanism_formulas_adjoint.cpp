// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/mechanism_formulas_in.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_FORMULAS(, LagrangeMultipliers, AdjointErrorNumbers);
DYNWITNESS_FORMULAS(, DenseSystem, AdjointErrorNumbers);
DYNWITNESS_FORMULAS(, LoopsEliminated, AdjointErrorNumbers);
DYNWITNESS_FORMULAS(, HybridSweep, AdjointErrorNumbers);

}  // namespace dynwitness::crosscheck
