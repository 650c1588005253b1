// SPDX-License-Identifier: GPL-3.0-or-later
// Both sides of the laws, with running error bounds.
#include "crosscheck/laws/compiled_identities.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_IDENTITIES(, RunningError);

}  // namespace dynwitness::crosscheck
