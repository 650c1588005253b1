// SPDX-License-Identifier: GPL-3.0-or-later
// Smaller models whose joint accelerations stay near the scene's over an envelope, guaranteed.
#pragma once

#include "crosscheck/reduction/reduce.hpp"

namespace dynwitness::crosscheck {

/** reduced() for |qdd_i - reduced qdd_i| <= allowed x max |qdd_i|, for every joint i and all q, qd
    and tau of the envelope: scenes without terms, of which the one with the fewest parameters is
    taken that is within what is allowed and takes fewer operations of forward dynamics.

    The scene's accelerations are bounded first (AccelerationBounds), then the errors at the
    same q, qd and tau (AccelerationErrors), by what is allowed of all joints together. */
Reduction reducedInAcceleration(const scene::Scene& scene,
                                const std::vector<scene::JointRanges>& ranges,
                                const ReduceOptions& options,
                                const std::function<void(const std::string&)>& stage);

/// The scene's M and gravity less the reduced one's: all else of tau is common to both.
TrigonometricModel difference(const TrigonometricModel& scene, const TrigonometricModel& reduced);

}  // namespace dynwitness::crosscheck
