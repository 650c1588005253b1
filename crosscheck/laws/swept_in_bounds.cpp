// SPDX-License-Identifier: GPL-3.0-or-later
// What the laws ask about, with running error bounds.
#include "crosscheck/laws/compiled_identities.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_SWEPT(, RunningError, RunningErrorNumbers);

}  // namespace dynwitness::crosscheck
