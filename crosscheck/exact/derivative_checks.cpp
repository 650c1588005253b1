// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/derivative_checks.hpp"

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/verdicts/check_derivatives.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkDerivativesExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const scene::Mechanism* derived) {
  return checkDerivativesExactly(scene, options,
                                 LagrangeDerivatives(derived ? *derived : scene.mechanism,
                                                     options.parameters == Parameters::kAsWritten));
}

std::vector<CheckResult> checkDerivativesExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const LagrangeDerivatives& derived) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const std::vector<DerivativePair> pairs = derivativePairs(mechanism);
  Inquiry inquiry;
  for (const DerivativePair& pair : pairs) inquiry.checks.push_back(inWords(pair));
  inquiry.ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state,
                    const std::vector<char>&) {
    DerivativeRoads<PrimeField> roads(mechanism, derived, number);
    roads.at(state);
    SidesOfAll sides;
    for (const DerivativePair& pair : pairs) sides.push_back(roads.sides(pair));
    return sides;
  };
  return decide(scene, inquiry, options);
}

}  // namespace dynwitness::crosscheck
