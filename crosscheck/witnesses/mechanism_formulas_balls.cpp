// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/mechanism_formulas_in.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_FORMULAS(, LagrangeMultipliers, BallNumbers);

}  // namespace dynwitness::crosscheck
