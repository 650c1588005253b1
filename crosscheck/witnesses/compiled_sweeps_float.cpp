// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps in float.
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, float);
DYNWITNESS_MODELS(, float, scene::RealNumbers<float>);

}  // namespace dynwitness::recursive
