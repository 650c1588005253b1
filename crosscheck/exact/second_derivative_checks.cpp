// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/second_derivative_checks.hpp"

#include <utility>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/laws/second_derivative_roads.hpp"

namespace dynwitness::crosscheck {

std::vector<CheckResult> checkSecondDerivativesExactly(const scene::Scene& scene,
                                                       const ExactOptions& options,
                                                       const scene::Mechanism* derived) {
  return checkSecondDerivativesExactly(
      scene, options,
      LagrangeDerivatives(derived ? *derived : scene.mechanism,
                          options.parameters == Parameters::kAsWritten));
}

std::vector<CheckResult> checkSecondDerivativesExactly(const scene::Scene& scene,
                                                       const ExactOptions& options,
                                                       const LagrangeDerivatives& derived) {
  const scene::Mechanism& mechanism = scene.mechanism;
  std::vector<CheckResult> checks;
  // apart, since degrees of qdd grow with every joint that is solved for
  for (const bool of_forces : {true, false}) {
    std::vector<SecondPair> pairs;
    Inquiry inquiry;
    for (const SecondPair& pair : secondPairs(mechanism)) {
      if (isOfForces(pair.quantity) != of_forces) continue;
      pairs.push_back(pair);
      inquiry.checks.push_back(sameInWords(name(pair.quantity), name(pair.left), name(pair.right)));
    }
    inquiry.ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state,
                      const std::vector<char>& wanted) {
      SecondDerivativeRoads<PrimeField> roads(mechanism, derived, number);
      roads.at(state);
      SidesOfAll sides(pairs.size());
      for (std::size_t i = 0; i < pairs.size(); ++i)
        if (wanted[i] != 0) sides[i] = roads.sides(pairs[i]);
      return sides;
    };
    for (CheckResult& check : decide(scene, inquiry, options)) checks.push_back(std::move(check));
  }
  return checks;
}

}  // namespace dynwitness::crosscheck
