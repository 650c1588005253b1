// SPDX-License-Identifier: GPL-3.0-or-later
// Kinematics of a point by two roads, over the prime field.
#pragma once

#include <vector>

#include "crosscheck/exact/exact.hpp"

namespace dynwitness::crosscheck {

/** The laws of laws/point_laws.hpp.
    @param swept  what the sweeps read instead of the scene: tests plant their errors there */
std::vector<CheckResult> checkPointsExactly(const scene::Scene& scene, const ExactOptions& options,
                                            const scene::Mechanism* swept = nullptr);

}  // namespace dynwitness::crosscheck
