// SPDX-License-Identifier: GPL-3.0-or-later
// The fast derivatives with each rounding weighed by what it does.
#include "crosscheck/witnesses/fast_derivatives.hpp"

namespace dynwitness::crosscheck {

template class FastDerivatives<AdjointError>;

}  // namespace dynwitness::crosscheck
