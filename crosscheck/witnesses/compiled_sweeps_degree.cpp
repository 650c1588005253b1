// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps on degrees of formulas.
#include "crosscheck/scalars/degree.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, crosscheck::DegreeBound);
DYNWITNESS_MODELS(, crosscheck::DegreeBound, crosscheck::DegreeNumbers);

}  // namespace dynwitness::recursive
