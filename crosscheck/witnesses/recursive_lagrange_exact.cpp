// SPDX-License-Identifier: GPL-3.0-or-later
// Recursive Lagrange over the prime field.
#include "crosscheck/witnesses/recursive_lagrange.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_RECURSIVE_LAGRANGE(, PrimeField, FieldNumbers);

}  // namespace dynwitness::crosscheck
