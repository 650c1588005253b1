// SPDX-License-Identifier: GPL-3.0-or-later
// Kinematics as checks: a point of the last link, by two roads.
#pragma once

#include <vector>

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/prepared_scene.hpp"

namespace dynwitness::crosscheck {

/// The laws of laws/point_laws.hpp at seeded states, within running error bounds.
std::vector<CheckResult> checkPoints(const PreparedScene& scene, const Options& options);

}  // namespace dynwitness::crosscheck
