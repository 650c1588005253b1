// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps at many states, compiled once (many_states.cpp), and not again in every file that
// asks them.
#pragma once

#include "recursive/fast/many_states.hpp"

namespace dynwitness::recursive::fast::detail {

// NOLINTBEGIN(bugprone-macro-parentheses) PREFIX extern: compiled elsewhere; empty: here
#define DYNWITNESS_MANY_STATES(PREFIX, WIDTH)                                                      \
  PREFIX template void sweep<Sweep::kInverseDynamics>(const Plan<double>&,                         \
                                                      ManyStatesWorkspace<WIDTH>&, const Asked&);  \
  PREFIX template void sweep<Sweep::kMassMatrix>(const Plan<double>&, ManyStatesWorkspace<WIDTH>&, \
                                                 const Asked&);                                    \
  PREFIX template void sweep<Sweep::kPackedMassMatrix>(const Plan<double>&,                        \
                                                       ManyStatesWorkspace<WIDTH>&, const Asked&); \
  PREFIX template void sweep<Sweep::kForwardDynamics>(const Plan<double>&,                         \
                                                      ManyStatesWorkspace<WIDTH>&, const Asked&)
// NOLINTEND(bugprone-macro-parentheses)

DYNWITNESS_MANY_STATES(extern, 2);
#ifdef __x86_64__
DYNWITNESS_MANY_STATES(extern, 4);
DYNWITNESS_MANY_STATES(extern, 8);
#endif

}  // namespace dynwitness::recursive::fast::detail
