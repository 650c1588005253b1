// SPDX-License-Identifier: GPL-3.0-or-later
// Laws as checks: their words, and their two sides within rounding.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// Checks with these words and no verdict yet.
std::vector<CheckResult> inWords(const std::vector<LawWords>& laws);

/// A quantity by two who answer it, "M by left = M by right", and no verdict yet.
CheckResult sameInWords(const std::string& quantity, const std::string& left,
                        const std::string& right);

/// The checks of these laws, of which those without a value say what that means.
std::vector<CheckResult> explained(const std::vector<LawWords>& laws,
                                   std::vector<CheckResult> checks);

/// Each law at one state: the two sides must lie within the sum of their running error bounds.
std::vector<CheckResult> withinBounds(const std::vector<LawWords>& laws,
                                      const std::vector<TwoSides<RunningError>>& sides);

}  // namespace dynwitness::crosscheck
