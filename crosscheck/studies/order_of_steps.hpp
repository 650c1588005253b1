// SPDX-License-Identifier: GPL-3.0-or-later
// Whether what is 0 in truth falls as the steps are halved, as it must.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// Nothing is said, for this reason.
void leaveOpen(CheckResult* check, const std::string& reason);

/// What is 0 in truth, as one size of the steps has it.
struct StepResidual {
  std::vector<double> at;       ///< with a sign: entries that all sizes of steps have
  double worst = 0, terms = 0;  ///< largest magnitude anywhere; of the terms that it is left of

  void add(double difference, bool is_shared) {
    worst = std::isfinite(difference) ? std::max(worst, std::abs(difference))
                                      : std::numeric_limits<double>::infinity();
    if (is_shared) at.push_back(difference);
  }
};

/** What is 0 in truth falls with the order of the method as the steps are halved: an order above
    kOrder - 1, or all that is left is rounding: an eps of the largest term a step, and what it
    moves to round the state.

    What does neither is guilty only where the steps have settled: its changes fall with that order
    themselves, or to rounding, and the last one, more than seven times all that are still to come,
    is too little for it to be 0. Otherwise it is the steps that fail.

    @param seen    by steps that are halved each time, two sizes at least
    @param size    of what is compared: a limit that reaches it would let everything pass
    @param moved   by rounding the state in all steps, asked where the order alone does not tell */
void judgeOrder(CheckResult* check, const std::vector<StepResidual>& seen, double size,
                const std::function<double()>& moved, int steps);

}  // namespace dynwitness::crosscheck
