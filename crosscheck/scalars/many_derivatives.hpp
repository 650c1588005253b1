// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives at many states, compiled once (many_derivatives_*.cpp, a file a width).
#pragma once

#include "recursive/fast/many_derivatives.hpp"

namespace dynwitness::recursive::fast::detail {

// NOLINTBEGIN(bugprone-macro-parentheses) PREFIX extern: compiled elsewhere; empty: here
#define DYNWITNESS_MANY_DERIVATIVES(PREFIX, OF_ACCELERATIONS, WIDTH) \
  PREFIX template void differentiate<OF_ACCELERATIONS>(              \
      const Plan<double>&, ManyDerivativesWorkspace<WIDTH>&, const AskedDerivatives&)
// NOLINTEND(bugprone-macro-parentheses)

DYNWITNESS_MANY_DERIVATIVES(extern, false, 2);
DYNWITNESS_MANY_DERIVATIVES(extern, true, 2);
#ifdef __x86_64__
DYNWITNESS_MANY_DERIVATIVES(extern, false, 4);
DYNWITNESS_MANY_DERIVATIVES(extern, true, 4);
DYNWITNESS_MANY_DERIVATIVES(extern, false, 8);
DYNWITNESS_MANY_DERIVATIVES(extern, true, 8);
#endif

}  // namespace dynwitness::recursive::fast::detail
