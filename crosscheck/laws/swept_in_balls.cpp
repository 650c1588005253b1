// SPDX-License-Identifier: GPL-3.0-or-later
// What the laws ask about, in balls.
#include "crosscheck/laws/compiled_identities.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_SWEPT(, Ball, BallNumbers);

}  // namespace dynwitness::crosscheck
