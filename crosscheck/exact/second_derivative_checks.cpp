// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/second_derivative_checks.hpp"

#include <fmt/format.h>

#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/laws/second_derivative_roads.hpp"
#include "crosscheck/witnesses/lagrange.hpp"

namespace dynwitness::crosscheck {
namespace {

CheckResult inWords(const SecondPair& pair) {
  CheckResult check;
  check.kind = CheckKind::kSame;
  check.quantity = name(pair.quantity);
  check.left = name(pair.left);
  check.right = name(pair.right);
  check.statement = fmt::format("{0} by {1} = {0} by {2}", check.quantity, check.left, check.right);
  return check;
}

}  // namespace

std::vector<CheckResult> checkSecondDerivativesExactly(const scene::Scene& scene,
                                                       const ExactOptions& options,
                                                       const scene::Mechanism* derived) {
  return checkSecondDerivativesExactly(
      scene, options,
      DerivedPrograms(derived ? *derived : scene.mechanism,
                      options.parameters == Parameters::kAsWritten));
}

std::vector<CheckResult> checkSecondDerivativesExactly(const scene::Scene& scene,
                                                       const ExactOptions& options,
                                                       const DerivedPrograms& derived) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const LagrangeDerivatives programs(derived.forces());
  const std::vector<SecondPair> pairs = secondPairs(mechanism);
  Inquiry inquiry;
  for (const SecondPair& pair : pairs) inquiry.checks.push_back(inWords(pair));
  inquiry.ask = [&](const FieldNumbers& number, const scene::State<PrimeField>& state,
                    const std::vector<char>&) {
    SecondDerivativeRoads<PrimeField> roads(mechanism, programs, number);
    roads.at(state);
    SidesOfAll sides;
    for (const SecondPair& pair : pairs) sides.push_back(roads.sides(pair));
    return sides;
  };
  return decide(scene, inquiry, options);
}

}  // namespace dynwitness::crosscheck
