// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of the kinetic metric over the field.
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/studies/geometry_laws.hpp"
#include "crosscheck/studies/given_values.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkGeometryExactly(const scene::Scene& scene,
                                              const ExactOptions& options) {
  requireTreated(scene, Command::kGeometry);
  const auto ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    using T = PrimeField;
    return GeometryLaws::sides(scene.mechanism, MetricAsked<T>(scene.mechanism, number, state));
  };
  std::vector<CheckResult> checks =
      decide(scene, GeometryLaws::words(scene.mechanism), ask, options);
  if (scene.mechanism.closures.empty()) return checks;
  const Surface surface = surfaceNear(scene, inDouble(scene, scene.start_q));
  const char* reason =
      surface.rates.empty() ? "closures leave nothing free to move"
      : surface.has_dependent_rows
          ? "closures depend on each other where they hold, and nowhere else: the surfaces of the "
            "field are others"
          : nullptr;
  if (reason == nullptr) return checks;
  for (CheckResult& check : checks) {
    check.verdict = Verdict::kNotAnswerable;
    check.reason = reason;
  }
  return checks;
}

}  // namespace dynwitness::crosscheck
