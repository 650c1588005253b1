// SPDX-License-Identifier: GPL-3.0-or-later
// Roads to the motion and forces of a whole mechanism against each other, pair by pair.
#pragma once

#include <vector>

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/mechanism_roads.hpp"

namespace dynwitness::crosscheck {

/// At so many states, or at as many as are asked for, if these are fewer: what closures, drives and
/// constraints do depends on the structure, which is the same at each. A state of n rates costs n^3
/// operations, all on a tape: beyond 40 rates there are as many as cost what 10 do there, 2 at
/// least.
inline constexpr int kMechanismStates = 10;

/** Each quantity that the mechanism has (MechanismQuantity), each pair of roads that answer it:
    |left - right| must lie within the sum of both sides' limits, entry by entry; and each road
    against the certified truth, within its own limit. A road that cannot hold the scene is a check
    that says why. Nothing where the tree is the whole mechanism.

    A quantity that does not exist (lambda of redundant closures) is excused; a state that cannot be
    closed, a road that throws, are held against the run. */
std::vector<CheckResult> checkMechanism(const PreparedScene& scene, const Options& options);

/// The same of these roads.
std::vector<CheckResult> compareRoads(const PreparedScene& scene,
                                      const std::vector<NamedRoad>& roads, const Options& options);

}  // namespace dynwitness::crosscheck
