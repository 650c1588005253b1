// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of the kinetic metric over the field.
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/studies/geometry_laws.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkGeometryExactly(const scene::Scene& scene,
                                              const ExactOptions& options) {
  requireTreated(scene, Command::kGeometry);
  const auto ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    using T = PrimeField;
    return GeometryLaws::sides(scene.mechanism, MetricAsked<T>(scene.mechanism, number, state));
  };
  return decide(scene, GeometryLaws::words(scene.mechanism), ask, options);
}

}  // namespace dynwitness::crosscheck
