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

/** At seeded states, along a direction u drawn with each:
      same     every pair of laws/derivative_roads.hpp in balls
      truth    what the sweeps for derivatives answer in double, against the textbook's in balls:
               those of tau entry by entry within their running error bounds, those of qdd by what
               M dqdd_dq u leaves of -dtau_dq u, within what each rounding does to it (to first
               order); digits are counted entry by entry
      witness  not answerable: why the fast road does not go there
    @param answering  what is answered in double instead of the scene: tests plant their errors
      there */
std::vector<CheckResult> checkDerivatives(const PreparedScene& scene, const Options& options,
                                          const PreparedScene* answering = nullptr);

}  // namespace dynwitness::crosscheck
