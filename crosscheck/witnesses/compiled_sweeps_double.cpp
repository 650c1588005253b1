// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps on doubles.
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, double);
DYNWITNESS_MODELS(, double, scene::RealNumbers<double>);

}  // namespace dynwitness::recursive
