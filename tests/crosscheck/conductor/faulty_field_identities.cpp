// SPDX-License-Identifier: GPL-3.0-or-later
// Both sides of the laws.
#include "tests/crosscheck/conductor/faulty_field.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_IDENTITIES(, fixtures::Faulty);

}  // namespace dynwitness::crosscheck
