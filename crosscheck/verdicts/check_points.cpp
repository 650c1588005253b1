// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/check_points.hpp"

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/laws/point_laws.hpp"
#include "crosscheck/verdicts/identity_tallies.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkPoints(const PreparedScene& prepared, const Options& options) {
  const scene::Scene& scene = prepared.scene();
  const RunningErrorNumbers number(scene.mechanism);
  IdentityTallies tallies(PointLaws::words(scene.mechanism), options.seed);
  for (int k = 0; k < options.states; ++k) {
    const scene::State<double> drawn = drawState(scene.mechanism, scene.name, options.seed, k);
    const PointOfMechanism<RunningError> point(scene.mechanism, prepared.model<RunningError>(),
                                               number, runningErrorState(drawn, scene.mechanism));
    tallies.add(k, PointLaws::sides(scene.mechanism, point), [](int) { return std::string(); });
  }
  return tallies.results();
}

}  // namespace dynwitness::crosscheck
