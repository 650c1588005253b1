// SPDX-License-Identifier: GPL-3.0-or-later
// Checks over the prime field that are asked together, and how they are decided.
#pragma once

#include <functional>
#include <vector>

#include "crosscheck/exact.hpp"
#include "crosscheck/identities.hpp"

namespace dynwitness::crosscheck {

template <typename T>
using SidesOfAll = std::vector<TwoSides<T>>;

struct Inquiry {
  std::vector<CheckResult> checks;  ///< what is asked, in words
  std::function<SidesOfAll<PrimeField>(const FieldNumbers&, const scene::State<PrimeField>&)> in_field;
  std::function<SidesOfAll<DegreeBound>(const DegreeNumbers&, const scene::State<DegreeBound>&)>
      in_degrees;
};

/// Asks at as many points as the size of the formulas takes, one result a check.
std::vector<CheckResult> decide(const scene::Scene& scene, const Inquiry& inquiry,
                                const ExactOptions& options);

/// What of the constrained motion the scene has to show: closures, driven joints, acceleration constraints.
/// No checks where it has none of them.
std::vector<CheckResult> checkConstrainedExactly(const scene::Scene& scene, const ExactOptions& options);

}  // namespace dynwitness::crosscheck
