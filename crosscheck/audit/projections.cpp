// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/audit/trial.hpp"

namespace dynwitness::audit {

std::vector<Claim> projections() { return {}; }

}  // namespace dynwitness::audit
