// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of tau and qdd as checks: roads against each other, and answers in double against
// the certified truth.
#pragma once

#include <vector>

#include "crosscheck/laws/derivative_roads.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/prepared_scene.hpp"

namespace dynwitness::crosscheck {

/// A pair as a check without a verdict yet.
CheckResult inWords(const DerivativePair& pair);

/** At seeded states:
      same   every pair of laws/derivative_roads.hpp in balls
      truth  what the sweeps for derivatives answer in double, against the textbook's in balls,
             within their running error bounds
      witness  not answerable: why the fast road does not go there */
std::vector<CheckResult> checkDerivatives(const PreparedScene& scene, const Options& options);

}  // namespace dynwitness::crosscheck
