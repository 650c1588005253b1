// SPDX-License-Identifier: GPL-3.0-or-later
// What the sweeps cost, by running them on a scalar that counts.
#pragma once

#include "crosscheck/audit/counting.hpp"
#include "recursive/model.hpp"

namespace dynwitness::audit {

/// A chain of n turning joints in general position.
recursive::Model<Counted> chainOfTurns(int n);

/// Operations of one evaluation for chainOfTurns(n).
struct Cost {
  long mass_matrix, solve, articulated, inverse;
};
Cost costOf(int n);

}  // namespace dynwitness::audit
