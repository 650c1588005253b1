// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of tau and qdd by four roads, over the prime field.
#pragma once

#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/witnesses/lagrange_derivatives.hpp"

namespace dynwitness::crosscheck {

/// Every pair of laws/derivative_roads.hpp. @param derived  what Lagrange's side says
std::vector<CheckResult> checkDerivativesExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const LagrangeDerivatives& derived);

/** The same.
    @param derived  what Lagrange's side is derived from instead of the scene: tests plant their
      errors there */
std::vector<CheckResult> checkDerivativesExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const scene::Mechanism* derived = nullptr);

}  // namespace dynwitness::crosscheck
