// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/many_states.hpp"

namespace dynwitness::recursive::fast::detail {

DYNWITNESS_MANY_STATES(, 2);
#ifdef __x86_64__
DYNWITNESS_MANY_STATES(, 4);
DYNWITNESS_MANY_STATES(, 8);
#endif

}  // namespace dynwitness::recursive::fast::detail
