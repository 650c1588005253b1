// SPDX-License-Identifier: GPL-3.0-or-later
// What the sweeps cost, by running them on a scalar that counts.
#pragma once

namespace dynwitness::audit {

/// Operations of one evaluation for a chain of n turning joints in general position.
struct Cost {
  long mass_matrix, solve, articulated, inverse;
};
Cost costOf(int n);

}  // namespace dynwitness::audit
