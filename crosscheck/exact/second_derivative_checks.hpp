// SPDX-License-Identifier: GPL-3.0-or-later
// Second derivatives of tau and qdd by three roads, over the prime field.
#pragma once

#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/witnesses/lagrange_derivatives.hpp"

namespace dynwitness::crosscheck {

/// Every pair of laws/second_derivative_roads.hpp.
/// @param derived  what Lagrange's side says
std::vector<CheckResult> checkSecondDerivativesExactly(const scene::Scene& scene,
                                                       const ExactOptions& options,
                                                       const LagrangeDerivatives& derived);

/** The same.
    @param derived  what Lagrange's side is derived from instead of the scene: tests plant their
      errors there */
std::vector<CheckResult> checkSecondDerivativesExactly(const scene::Scene& scene,
                                                       const ExactOptions& options,
                                                       const scene::Mechanism* derived = nullptr);

}  // namespace dynwitness::crosscheck
