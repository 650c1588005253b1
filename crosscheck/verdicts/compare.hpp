// SPDX-License-Identifier: GPL-3.0-or-later
// Witnesses against each other, pair by pair, and who stands alone.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Each quantity, each pair of witnesses that answer it, at the options' states: |left - right|
/// must lie within the sum of both sides' error bounds.
std::vector<CheckResult> compareWitnesses(const PreparedScene& scene,
                                          const std::vector<WitnessKind>& kinds,
                                          const Options& options);

/// Who stands alone: for each quantity in dispute, the witness that disagrees with all others while
/// these agree; where none does, who is off the certified truth.
std::vector<Finding> findOutliers(const std::string& scene_name,
                                  const std::vector<CheckResult>& checks);

}  // namespace dynwitness::crosscheck
