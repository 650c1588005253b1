// SPDX-License-Identifier: GPL-3.0-or-later
// Laws as checks: their words, and their two sides within rounding.
#pragma once

#include <vector>

#include "crosscheck/laws/two_sides.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// Checks with these words and no verdict yet.
template <std::size_t kCount>
std::vector<CheckResult> inWords(const IdentityInfo (&laws)[kCount]) {
  std::vector<CheckResult> checks;
  for (const IdentityInfo& law : laws) {
    checks.emplace_back();
    checks.back().check = law.name;
    checks.back().statement = law.statement;
    checks.back().quantity = law.quantity;
    checks.back().left = law.left;
    checks.back().right = law.right;
  }
  return checks;
}

/// Each law at one state: the two sides must lie within the sum of their running error bounds.
std::vector<CheckResult> withinBounds(const std::vector<CheckResult>& in_words,
                                      const std::vector<TwoSides<RunningError>>& sides);

}  // namespace dynwitness::crosscheck
