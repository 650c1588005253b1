// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps in long double.
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, long double);
DYNWITNESS_MODELS(, long double, scene::RealNumbers<long double>);

}  // namespace dynwitness::recursive
