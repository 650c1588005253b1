// SPDX-License-Identifier: GPL-3.0-or-later
// How a question is asked over the prime field: what it takes to add an exact check.
#pragma once

#include <functional>
#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/laws/law.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"

namespace dynwitness::crosscheck {

using SidesOfAll = std::vector<TwoSides<PrimeField>>;

/// Some checks that are asked together: both sides of each, asked once for the size of their
/// formulas and at each point for their values. Where a side cannot be had, `failure` says why.
struct Inquiry {
  std::vector<CheckResult> checks;  ///< what is asked, in words
  /// @param wanted  one entry a check: where it is 0 the sides need not be computed, since the
  ///   check has enough points, and this one is for others
  std::function<SidesOfAll(const FieldNumbers&, const scene::State<PrimeField>&,
                           const std::vector<char>& wanted)>
      ask = {};
};

/// The identities of identities.hpp; the mechanism must outlive it.
Inquiry identityInquiry(const scene::Mechanism& mechanism);

/// Every quantity, each pair of witnesses that answer it.
Inquiry comparisonInquiry(const std::vector<ExactWitness>& witnesses);

/// The checks of both, asked at the same points.
Inquiry both(const Inquiry& a, const Inquiry& b);

/// Asks at as many points as options.error_probability takes. Where asking divides by zero, no
/// check has a value at that point.
std::vector<CheckResult> decide(const scene::Scene& scene, const Inquiry& inquiry,
                                const ExactOptions& options);

/// The same of laws.
/// @param ask  their sides, on numbers and a state
template <typename Ask>
std::vector<CheckResult> decide(const scene::Scene& scene, const std::vector<LawWords>& laws,
                                const Ask& ask, const ExactOptions& options) {
  const auto all = [ask](const FieldNumbers& number, const scene::State<PrimeField>& state,
                         const std::vector<char>&) { return ask(number, state); };
  return explained(laws, decide(scene, Inquiry{inWords(laws), all}, options));
}

}  // namespace dynwitness::crosscheck
