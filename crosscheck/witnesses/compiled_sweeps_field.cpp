// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps on the prime field.
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::recursive {

DYNWITNESS_SWEEPS(, crosscheck::PrimeField);
DYNWITNESS_MODELS(, crosscheck::PrimeField, crosscheck::FieldNumbers);

}  // namespace dynwitness::recursive
