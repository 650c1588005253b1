// SPDX-License-Identifier: GPL-3.0-or-later
// Steps from many states, compiled once (many_steps.cpp).
#pragma once

#include "recursive/fast/many_steps.hpp"

namespace dynwitness::recursive::fast::detail {

// NOLINTBEGIN(bugprone-macro-parentheses) PREFIX extern: compiled elsewhere; empty: here
#define DYNWITNESS_MANY_STEPS(PREFIX, WIDTH)                               \
  PREFIX template void step<Integrator::kSemiImplicitEuler>(               \
      const Plan<double>&, ManyStepsWorkspace<WIDTH>&, const AskedSteps&); \
  PREFIX template void step<Integrator::kRungeKutta4>(                     \
      const Plan<double>&, ManyStepsWorkspace<WIDTH>&, const AskedSteps&)
// NOLINTEND(bugprone-macro-parentheses)

DYNWITNESS_MANY_STEPS(extern, 2);
#ifdef __x86_64__
DYNWITNESS_MANY_STEPS(extern, 4);
DYNWITNESS_MANY_STEPS(extern, 8);
#endif

}  // namespace dynwitness::recursive::fast::detail
