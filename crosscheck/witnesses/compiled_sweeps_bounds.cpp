// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps on running error bounds.
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, crosscheck::RunningError);
DYNWITNESS_MODELS(, crosscheck::RunningError, crosscheck::RunningErrorNumbers);

}  // namespace dynwitness::recursive
