// SPDX-License-Identifier: GPL-3.0-or-later
// What the laws ask about, over the prime field.
#include "crosscheck/laws/compiled_identities.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_SWEPT(, PrimeField, FieldNumbers);

}  // namespace dynwitness::crosscheck
