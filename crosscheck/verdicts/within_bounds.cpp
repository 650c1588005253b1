// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/within_bounds.hpp"

#include "crosscheck/verdicts/tally.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> withinBounds(const std::vector<CheckResult>& in_words,
                                      const std::vector<TwoSides<RunningError>>& sides) {
  const auto value = [](const RunningError& x) { return x.value(); };
  const auto bound = [](const RunningError& x) { return x.bound(); };
  std::vector<CheckResult> results;
  for (std::size_t i = 0; i < in_words.size(); ++i) {
    Tally tally(in_words[i]);
    if (!sides[i].failure.empty())
      tally.fail(0, sides[i].failure);
    else
      tally.add(0, sides[i].left.unaryExpr(value), sides[i].right.unaryExpr(value),
                sides[i].left.unaryExpr(bound) + sides[i].right.unaryExpr(bound));
    results.push_back(tally.result());
  }
  return results;
}

}  // namespace dynwitness::crosscheck
