// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/check_drift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace dynwitness::crosscheck {
namespace {

std::string unresolved(const Drift& drift) {
  if (!isFinite(drift))
    return fmt::format(
        "the motion leaves the numbers (NaN or infinite energy) at steps of {:.2g} s",
        drift.paths.back().step);
  return fmt::format("energy drift falls with order {:.2f} down to steps of {:.2g} s; {} has {}",
                     drift.observed_order, drift.paths.back().step, drift.method,
                     drift.method_order);
}

/** Equal steps have failed: is it them, or qdd? An integrator that adapts asks every step for an
    error below its step_error, and so the error of the path, and of E, falls with what is asked of
    a step: as its power 5/6 with a method of order 5 that controls the error a step (Hairer,
    Norsett, Wanner, Solving Ordinary Differential Equations I, II.4). A wrong qdd drifts by the
    same amount whatever is asked, the power 0. Between the two lies 1/2.

    Where rounding is all that is left, the drift is held to the sum of what rounding the state does
    to E at each step. A sum above the kinetic energy itself would let everything pass, and nothing
    is answered. */
void judgeAdaptively(const PreparedScene& scene, const Drift& drift, DriftOptions options,
                     CheckResult* check) {
  constexpr double kStepErrors[] = {1e-6, 1e-8, 1e-10};
  constexpr double kLeastPower = 0.5;
  options.duration = drift.duration;
  std::vector<AdaptiveRun> runs;
  double time = drift.duration;
  for (const double step_error : kStepErrors) {
    runs.push_back(runAdaptively(scene, options, step_error));
    time = std::min(time, runs.back().end());
  }
  const std::string equal_steps = unresolved(drift);
  if (!(time > 0)) {
    check->verdict = Verdict::kNotAnswerable;
    check->ratio = check->worst = check->limit = 0;
    check->reason = fmt::format(
        "not answerable by this step: {}, and steps that adapt come no further than the start",
        equal_steps);
    return;
  }
  const AdaptiveRun& coarse = runs.front();
  const AdaptiveRun& fine = runs.back();
  const AdaptiveRun::Point &first = coarse.at(time), &last = fine.at(time);
  const double scale = last.kinetic;
  const double power =
      std::log(first.worst / last.worst) / std::log(coarse.step_error / fine.step_error);
  const std::string found = fmt::format(
      "{}; adaptive steps, down to {:.2g} s, drift by {:.2g}, {:.2g}, {:.2g} at step_errors of "
      "{:.0e}, {:.0e}, {:.0e}{}",
      equal_steps, fine.shortest_step, first.worst / scale, runs[1].at(time).worst / scale,
      last.worst / scale, coarse.step_error, runs[1].step_error, fine.step_error,
      time < drift.duration ? fmt::format(" until t = {:.3g} s", time) : "");
  if (power > kLeastPower) {
    check->statement = "|E - E0| falls with what is asked of a step of adaptive steps: " + found;
    check->unit = Unit::kPowerOfStepError;
    check->worst = power;
    check->limit = kLeastPower;
    check->ratio = kLeastPower / power;
  } else if (!(last.rounding < scale)) {
    check->verdict = Verdict::kNotAnswerable;
    check->ratio = check->worst = check->limit = 0;
    check->reason =
        fmt::format("not answerable by this step: {}; rounding alone may move E by {:.2g}", found,
                    last.rounding / scale);
  } else if (last.worst <= last.rounding) {
    check->statement = "|E - E0| is what rounding the state does to E in adaptive steps: " + found;
    check->unit = Unit::kRoundingOfSteps;
    check->worst = check->ratio = last.worst / last.rounding;
    check->limit = 1;
  } else {
    check->verdict = Verdict::kDisagree;
    check->ratio = std::numeric_limits<double>::infinity();
    check->reason = found;
  }
}

}  // namespace

CheckResult checkDrift(const PreparedScene& scene, const Drift& drift,
                       const DriftOptions& options) {
  CheckResult check;
  check.law = "energy drift";
  check.statement =
      fmt::format("|E - E0| falls as step^{} with {}", drift.method_order, drift.method);
  check.quantity = "energy";
  check.left = "articulated_body";
  check.unit = Unit::kObservedOrder;
  check.states = static_cast<int>(drift.paths.size());
  check.worst = drift.observed_order;
  check.limit = drift.method_order - 1;
  if (drift.paths.empty()) {
    check.verdict = Verdict::kNotAnswerable;
    check.reason = kNoMotion;
  } else if (drift.scale == 0) {
    check.verdict = Verdict::kNotAnswerable;
    check.reason = "nothing moves from the start state: give the scene a [start]";
  } else if (!isResolved(drift)) {
    judgeAdaptively(scene, drift, options, &check);
  } else if (belowRounding(drift)) {
    check.unit = Unit::kRoundingOfSteps;
    check.ratio = check.worst = drift.paths.back().worst / roundingFloor(drift, drift.paths.back());
    check.limit = 1;
  } else {
    check.ratio = check.limit / check.worst;
  }
  return check;
}

}  // namespace dynwitness::crosscheck
