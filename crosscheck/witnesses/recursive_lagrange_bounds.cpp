// SPDX-License-Identifier: GPL-3.0-or-later
// Recursive Lagrange with running errors.
#include "crosscheck/witnesses/recursive_lagrange.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_RECURSIVE_LAGRANGE(, RunningError, RunningErrorNumbers);
DYNWITNESS_RECURSIVE_LAGRANGE(, AdjointError, AdjointErrorNumbers);

}  // namespace dynwitness::crosscheck
