// SPDX-License-Identifier: GPL-3.0-or-later
// The fast derivatives in balls.
#include "crosscheck/witnesses/fast_derivatives.hpp"

namespace dynwitness::crosscheck {

template class FastDerivatives<Ball>;

}  // namespace dynwitness::crosscheck
