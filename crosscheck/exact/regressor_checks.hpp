// SPDX-License-Identifier: GPL-3.0-or-later
// The regressor of the sweeps against that of the derivation, over the prime field.
#pragma once

#include <vector>

#include "crosscheck/exact/exact.hpp"

namespace dynwitness::crosscheck {

/** Y of recursive/regressor.hpp, by spatial algebra, against dtau/dpi of symbolic/regressor.hpp, by
    differentiating the equations that follow from T and V: w' Y with w the joint forces of the
    point. They are elements of their own, so that equality is that of every entry of Y.
    @param derived  what Lagrange's side is derived from instead of the scene: tests plant their
                     errors there */
std::vector<CheckResult> checkRegressorExactly(const scene::Scene& scene,
                                               const ExactOptions& options,
                                               const scene::Mechanism* derived = nullptr);

}  // namespace dynwitness::crosscheck
