// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/many_derivatives.hpp"

namespace dynwitness::recursive::fast::detail {

DYNWITNESS_MANY_DERIVATIVES(, false, 2);
DYNWITNESS_MANY_DERIVATIVES(, true, 2);

}  // namespace dynwitness::recursive::fast::detail
