// SPDX-License-Identifier: GPL-3.0-or-later
// Both sides of the laws.
#include "tests/crosscheck/laws/rational_laws.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_IDENTITIES(, fixtures::Q);

}  // namespace dynwitness::crosscheck
