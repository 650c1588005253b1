// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/exact_checks.hpp"

#include "crosscheck/exact/derivative_checks.hpp"
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/exact/point_checks.hpp"
#include "crosscheck/exact/regressor_checks.hpp"
#include "crosscheck/exact/second_derivative_checks.hpp"
#include "crosscheck/witnesses/lagrange.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> exactChecks(const PreparedScene& prepared, const ExactOptions& options) {
  const scene::Scene& scene = prepared.scene();
  const std::vector<ExactWitness> witnesses = exactWitnesses(
      prepared, options.parameters, options.witnesses.empty() ? witnessKinds() : options.witnesses);
  scene::Work work("", 7);
  std::vector<CheckResult> checks =
      decide(scene, both(comparisonInquiry(witnesses), identityInquiry(scene.mechanism)), options);
  const auto add = [&](const std::vector<CheckResult>& more) {
    work.done();
    checks.insert(checks.end(), more.begin(), more.end());
  };
  const DerivedPrograms& derived = prepared.derived(options.parameters == Parameters::kAsWritten);
  add(checkPointsExactly(scene, options));
  const LagrangeDerivatives derivatives(derived.forces());
  add(checkDerivativesExactly(scene, options, derivatives));
  add(checkSecondDerivativesExactly(scene, options, derivatives));
  add(checkClosuresExactly(scene, options, derived));
  add(checkRegressorExactly(scene, options));
  add(checkConstrainedExactly(scene, options, derived));
  return checks;
}

}  // namespace dynwitness::crosscheck
