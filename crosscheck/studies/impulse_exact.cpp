// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of impulses over the field.
#include <numeric>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/studies/impulse.hpp"
#include "crosscheck/studies/impulse_laws.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkImpulsesExactly(const scene::Scene& scene, const std::string& link,
                                              const ExactOptions& options) {
  const int struck = linkNamed(scene, link);
  int equations = 0;
  for (const scene::Closure& closure : scene.mechanism.closures)
    equations += scene::equationCount(closure.kind);
  std::vector<int> rows(equations);
  std::iota(rows.begin(), rows.end(), 0);
  const auto ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state) {
    using T = PrimeField;
    Powers<T> any(state.qdd[0]);  // what the laws do not use otherwise
    Impulse<T> impulse;
    impulse.point = {struck, any.vector()};
    impulse.p.force = any.vector();
    impulse.p.moment = any.vector();
    impulse.joints = state.tau;
    impulse.direction = any.vector();
    impulse.restitution = any();
    ImpulseModel<T> model(scene.mechanism, number, rows);
    return ImpulseLaws::sides(scene.mechanism, Blow<T>(model, state, impulse));
  };
  return decide(scene, ImpulseLaws::words(scene.mechanism), ask, options);
}

}  // namespace dynwitness::crosscheck
