// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/many_derivatives.hpp"

#ifdef __x86_64__
namespace dynwitness::recursive::fast::detail {

DYNWITNESS_MANY_DERIVATIVES(, false, 4);
DYNWITNESS_MANY_DERIVATIVES(, true, 4);

}  // namespace dynwitness::recursive::fast::detail
#endif
