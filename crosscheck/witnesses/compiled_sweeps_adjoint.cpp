// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps on errors weighed by their derivatives.
#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, crosscheck::AdjointError);
DYNWITNESS_MODELS(, crosscheck::AdjointError, crosscheck::AdjointErrorNumbers);

}  // namespace dynwitness::recursive
