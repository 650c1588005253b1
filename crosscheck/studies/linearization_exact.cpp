// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of linearized motion over the field.
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/linearization.hpp"
#include "crosscheck/studies/linearization_laws.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkLinearizationExactly(const scene::Scene& scene,
                                                   const ExactOptions& options) {
  requireTreated(scene, Command::kLinearize);
  const auto ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    return LinearizationLaws::sides(scene.mechanism,
                                    LinearizationAsked<PrimeField>(scene.mechanism, number, state));
  };
  return decide(scene, LinearizationLaws::words(scene.mechanism), ask, options);
}

}  // namespace dynwitness::crosscheck
