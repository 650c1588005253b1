// SPDX-License-Identifier: GPL-3.0-or-later
// Both sides of the laws, over the prime field.
#include "crosscheck/laws/compiled_identities.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_IDENTITIES(, PrimeField);
DYNWITNESS_WANTED_IDENTITIES(, PrimeField);

}  // namespace dynwitness::crosscheck
