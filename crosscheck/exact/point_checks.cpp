// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/point_checks.hpp"

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/laws/point_laws.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkPointsExactly(const scene::Scene& scene, const ExactOptions& options,
                                            const scene::Mechanism* swept) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const auto ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    const auto model = recursive::buildModel(swept == nullptr ? mechanism : *swept, number);
    return PointLaws::sides(mechanism,
                            PointOfMechanism<PrimeField>(mechanism, model, number, state));
  };
  return decide(scene, PointLaws::words(mechanism), ask, options);
}

}  // namespace dynwitness::crosscheck
