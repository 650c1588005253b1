// SPDX-License-Identifier: GPL-3.0-or-later
// What the laws ask about.
#include "tests/crosscheck/laws/rational_laws.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_SWEPT(, fixtures::Q, fixtures::RationalNumbers);

}  // namespace dynwitness::crosscheck
