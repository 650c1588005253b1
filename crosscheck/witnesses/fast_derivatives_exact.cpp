// SPDX-License-Identifier: GPL-3.0-or-later
// The fast derivatives over the prime field.
#include "crosscheck/witnesses/fast_derivatives.hpp"

namespace dynwitness::crosscheck {

template class FastDerivatives<PrimeField>;

}  // namespace dynwitness::crosscheck
