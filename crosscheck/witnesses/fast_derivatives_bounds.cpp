// SPDX-License-Identifier: GPL-3.0-or-later
// The fast derivatives with running errors.
#include "crosscheck/witnesses/fast_derivatives.hpp"

namespace dynwitness::crosscheck {

template class FastDerivatives<RunningError>;

}  // namespace dynwitness::crosscheck
