// SPDX-License-Identifier: GPL-3.0-or-later
// A law as two sides that must be equal.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/arithmetic/running_error.hpp"
#include "crosscheck/result.hpp"

namespace dynwitness::crosscheck {

/// An identity in words: how it is called and whose computations it takes.
struct IdentityInfo {
  const char* name;
  const char* statement;
  const char* quantity;
  const char* left;
  const char* right;
};

/// What must be equal, or why there is nothing to compare: then both sides are empty.
template <typename T>
struct TwoSides {
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> left, right;
  std::string failure = {};
};

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
