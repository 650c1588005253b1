// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/order_of_steps.hpp"

#include <fmt/format.h>

namespace dynwitness::crosscheck {
namespace {

constexpr int kOrder = 4;  // of the steps and of Simpson's sums

double largestDifference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace

void leaveOpen(CheckResult* check, const std::string& reason) {
  check->verdict = Verdict::kNotAnswerable;
  check->ratio = 0;
  check->reason = reason;
}

void judgeOrder(CheckResult* check, const std::vector<StepResidual>& seen, double size,
                const std::function<double()>& moved, int steps) {
  const StepResidual &fine = seen.back(), &coarse = seen[seen.size() - 2];
  const double rounding = std::numeric_limits<double>::epsilon() * fine.terms * steps;
  const double order = std::log2(coarse.worst / fine.worst);
  check->limit = kOrder - 1;
  check->unit = Unit::kObservedOrder;
  check->worst = order;
  if (!std::isfinite(fine.worst) || !std::isfinite(rounding)) {
    leaveOpen(check, fmt::format("it leaves the numbers in {} steps", steps));
    return;
  }
  if (fine.worst > rounding && std::isfinite(coarse.worst) && order > check->limit) {
    check->ratio = check->limit / order;
    return;
  }
  const double floor = fine.worst <= rounding ? rounding : rounding + moved();
  if (!std::isfinite(floor) || (floor >= size && size > 0)) {
    leaveOpen(check, fmt::format("not by {} steps: they round {:.3g} to within {:.3g}", steps, size,
                                 floor));
    return;
  }
  if (fine.worst <= floor) {
    check->unit = Unit::kRoundingOfSteps;
    check->worst = floor > 0 ? fine.worst / floor : 0;
    check->limit = 1;
    check->ratio = check->worst;
    return;
  }
  const std::string course =
      fmt::format("falls with order {:.2f} to {:.3g} at {} steps", order, fine.worst, steps);
  if (seen.size() > 2) {
    double largest = 0;
    for (const double x : fine.at) largest = std::max(largest, std::abs(x));
    const double last = largestDifference(fine.at, coarse.at),
                 before = largestDifference(coarse.at, seen[seen.size() - 3].at);
    const bool is_settled = last <= floor || std::log2(before / last) > kOrder - 1;
    if (is_settled && largest > floor + last) {
      check->ratio = std::numeric_limits<double>::infinity();
      check->verdict = Verdict::kDisagree;
      check->reason = fmt::format("{}, where it stays; {} is expected", course, kOrder);
      return;
    }
  }
  leaveOpen(check, course + ": these steps do not follow the motion closely enough to tell");
}

}  // namespace dynwitness::crosscheck
