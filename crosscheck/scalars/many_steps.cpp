// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/many_steps.hpp"

namespace dynwitness::recursive::fast::detail {

DYNWITNESS_MANY_STEPS(, 2);
#ifdef __x86_64__
DYNWITNESS_MANY_STEPS(, 4);
DYNWITNESS_MANY_STEPS(, 8);
#endif

}  // namespace dynwitness::recursive::fast::detail
