// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/mechanism_formulas_in.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_FORMULAS(, LagrangeMultipliers, scene::RealNumbers<double>);
DYNWITNESS_FORMULAS(, DenseSystem, scene::RealNumbers<double>);
DYNWITNESS_FORMULAS(, LoopsEliminated, scene::RealNumbers<double>);
DYNWITNESS_FORMULAS(, HybridSweep, scene::RealNumbers<double>);

}  // namespace dynwitness::crosscheck
