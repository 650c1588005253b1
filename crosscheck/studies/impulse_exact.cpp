// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of impulses over the field.
#include <numeric>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/studies/impulse.hpp"
#include "crosscheck/studies/impulse_laws.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkImpulsesExactly(const scene::Scene& scene, const std::string& link,
                                              const ExactOptions& options) {
  const int struck = linkNamed(scene, link);
  int equations = 0;
  for (const scene::Closure& closure : scene.mechanism.closures)
    equations += scene::equationCount(closure.kind);
  std::vector<int> rows(equations);
  std::iota(rows.begin(), rows.end(), 0);
  Inquiry inquiry;
  inquiry.checks = inWords(kImpulseLaws);
  const auto ask = [&](const auto& number, const auto& state) {
    using T = typename std::decay_t<decltype(number)>::Scalar;
    Powers<T> any(state.qdd[0]);  // what the laws do not use otherwise
    Impulse<T> impulse;
    impulse.point = {struck, any.vector()};
    impulse.p.force = any.vector();
    impulse.p.moment = any.vector();
    impulse.joints = state.tau;
    impulse.direction = any.vector();
    impulse.restitution = any();
    try {
      return ImpulseModel<T>(scene.mechanism, number, rows).laws(state, impulse);
    } catch (const DivisionByZero& error) {
      return std::vector<TwoSides<T>>(std::size(kImpulseLaws), TwoSides<T>{{}, {}, error.what()});
    }
  };
  inquiry.in_field = ask;
  inquiry.in_degrees = ask;
  return impulseLawsOf(scene.mechanism, decide(scene, inquiry, options));
}

}  // namespace dynwitness::crosscheck
