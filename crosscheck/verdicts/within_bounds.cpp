// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/within_bounds.hpp"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/verdicts/tally.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> inWords(const std::vector<LawWords>& laws) {
  std::vector<CheckResult> checks;
  for (const LawWords& law : laws) {
    checks.emplace_back();
    checks.back().law = law.name;
    checks.back().statement = law.statement;
    checks.back().quantity = law.quantity;
    checks.back().left = law.left;
    checks.back().right = law.right;
  }
  return checks;
}

CheckResult sameInWords(const std::string& quantity, const std::string& left,
                        const std::string& right) {
  CheckResult check;
  check.kind = CheckKind::kSame;
  check.quantity = quantity;
  check.left = left;
  check.right = right;
  check.statement = fmt::format("{0} by {1} = {0} by {2}", quantity, left, right);
  return check;
}

std::vector<CheckResult> explained(const std::vector<LawWords>& laws,
                                   std::vector<CheckResult> checks) {
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const std::string meaning = laws[i].without_value;
    if (!meaning.empty() && checks[i].verdict == Verdict::kNotAnswerable)
      checks[i].reason = meaning + " (" + checks[i].reason + ")";
  }
  return checks;
}

std::vector<CheckResult> withinBounds(const std::vector<LawWords>& laws,
                                      const std::vector<TwoSides<RunningError>>& sides) {
  const auto value = [](const RunningError& x) { return x.value(); };
  const auto bound = [](const RunningError& x) { return x.bound(); };
  const std::vector<CheckResult> in_words = inWords(laws);
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
  return explained(laws, std::move(results));
}

}  // namespace dynwitness::crosscheck
