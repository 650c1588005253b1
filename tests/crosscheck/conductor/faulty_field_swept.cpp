// SPDX-License-Identifier: GPL-3.0-or-later
// What the laws ask about.
#include "tests/crosscheck/conductor/faulty_field.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_SWEPT(, fixtures::Faulty, fixtures::FaultyNumbers);

}  // namespace dynwitness::crosscheck
