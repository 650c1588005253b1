// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/action_verdicts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/studies/motion_nodes.hpp"
#include "crosscheck/studies/order_of_steps.hpp"
#include "crosscheck/studies/second_variation.hpp"

namespace dynwitness::crosscheck::hamilton {

namespace {

constexpr int kMostDof = 10;  // whose second variation is formed

}  // namespace

CheckResult describe(const char* name, const char* statement, const char* quantity,
                     const char* left) {
  CheckResult check;
  check.law = name;
  check.statement = statement;
  check.quantity = quantity;
  check.left = left;
  check.states = 1;
  return check;
}

void countDirections(const Problem& problem, const std::vector<Node>& nodes, bool sharp,
                     Action* out, Lines* slowest) {
  CheckResult check =
      describe("directions that lower the action",
               "negative eigenvalues of the second variation = conjugate times", "S", "T - V");
  check.right = "articulated_body";
  check.unit = Unit::kDirections;
  if (problem.n() > kMostDof) {
    check.verdict = Verdict::kNotAnswerable;
    check.reason = fmt::format("{} freedoms; the second variation is formed for at most {}",
                               problem.n(), kMostDof);
    out->checks.push_back(check);
    return;
  }
  std::vector<Eigen::MatrixXd> H = hessians(problem, nodes);
  int expected = 0;
  for (const Action::Conjugate& conjugate : out->conjugates) expected += conjugate.multiplicity;
  // lines from node to node can miss a direction, never add one: finer ones until none is missed
  int coarse = negativeDirections(problem, H, 2);
  out->negative = negativeDirections(problem, H, 1);
  int steps = out->steps;
  while (out->negative < expected && 2 * steps <= kMostSteps) {
    steps *= 2;
    coarse = out->negative;
    H = hessians(problem, motionOf(problem, steps));
    out->negative = negativeDirections(problem, H, 1);
  }
  out->lowest = eigenvalue(problem, H, 1);
  if (out->negative > 0) *slowest = lowestDirection(problem, H, out->lowest);
  check.worst = std::abs(out->negative - expected);
  check.limit = 0;
  const std::string counts =
      fmt::format("{} negative eigenvalues, {} conjugate times", out->negative, expected);
  if (out->negative != expected && (!sharp || out->negative != coarse)) {
    leaveOpen(&check, fmt::format("{}; steps of twice the length count others: {} steps do not "
                                  "decide",
                                  counts, steps));
  } else if (out->negative != expected) {
    const int number = std::min(out->negative, expected) + 1;
    const double fine = eigenvalue(problem, H, number),
                 moved = std::abs(
                     eigenvalue(problem, hessians(problem, motionOf(problem, steps / 2)), number) -
                     fine);
    if (std::abs(fine) <= moved) {
      leaveOpen(&check, fmt::format("{}; eigenvalue {} is {:.3g}, and {} steps for {} move it by "
                                    "{:.3g}: they do not decide",
                                    counts, number, fine, steps / 2, steps, moved));
    } else {
      check.verdict = Verdict::kDisagree;
      check.ratio = std::numeric_limits<double>::infinity();
      check.reason = counts;
    }
  }
  out->checks.push_back(check);
}

void judgePaths(const std::vector<Action::Path>& paths, int negative, CheckResult* nearby) {
  nearby->states = 0;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const Action::Path& path = paths[k];
    const bool is_slow = path.kind == Action::Path::Kind::kSlowest, is_lower = path.change < 0;
    if (negative > 0 && !is_slow && path.kind != Action::Path::Kind::kFast)
      continue;  // may be either
    ++nearby->states;
    if (!(std::abs(path.change) > path.unsure)) {
      nearby->addVoided(static_cast<int>(k),
                        fmt::format("{}: S changes by {:.3g} J s, sure to within {:.3g}", path.name,
                                    path.change, path.unsure),
                        false);
    } else if (is_lower != is_slow) {
      nearby->worst += 1;
      nearby->verdict = Verdict::kDisagree;
      nearby->ratio = std::numeric_limits<double>::infinity();
      nearby->reason += fmt::format("{}: S changes by {:.3g} J s; ", path.name, path.change);
    }
  }
  if (nearby->verdict == Verdict::kDisagree) return;
  // one path that is higher shows a minimum as far as paths can; a saddle takes both
  if (nearby->judged() < (negative > 0 ? 2 : 1)) leaveOpen(nearby, nearby->voided_reason);
}

void judgePlaces(const std::vector<Node>& nodes, Action* out) {
  double farthest = 0;
  for (const Node& node : nodes)
    for (const double q : node.slots) farthest = std::max(farthest, std::abs(q));
  const double rounded = kRoundedByStep * farthest * out->steps;
  if (rounded < kAmplitude) return;
  for (CheckResult& check : out->checks)
    leaveOpen(&check, fmt::format("at a place of {:.3g}, {} steps round it by up to {:.3g}; varied "
                                  "paths are {} away",
                                  farthest, out->steps, rounded, kAmplitude));
}

}  // namespace dynwitness::crosscheck::hamilton
