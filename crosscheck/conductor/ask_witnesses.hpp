// SPDX-License-Identifier: GPL-3.0-or-later
// All witnesses of a scene, asked once a state and judged by each other, the truth and the control.
#pragma once

#include <vector>

#include "crosscheck/verdicts/digits.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// Takes them behind those that are there.
void append(std::vector<CheckResult>& all, std::vector<CheckResult> more);

/// measureDigits(), and each pair of witnesses into `checks`; those that cannot hold the scene
/// come first there. What became of the faults planted for control goes into `controls`.
DigitsFound askWitnesses(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                         const Options& options, std::vector<CheckResult>& checks,
                         std::vector<Control>& controls);

}  // namespace dynwitness::crosscheck
