// SPDX-License-Identifier: GPL-3.0-or-later
// Same mathematics? The comparisons and identities of the crosscheck over a prime field, where a
// residual is zero or it is not.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/scalars/degree.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

struct ExactOptions {
  std::uint64_t seed = 1;
  /// Each check runs at as many points as make the chance that it passes different formulas at most
  /// this.
  double error_probability = 1e-30;
  Parameters parameters = Parameters::kAsWritten;
  /// Names of those to compare, which may name others that do not compute exactly; empty: all. The
  /// identities are laws of our sweeps and hold whoever is compared.
  std::vector<std::string> witnesses = {};
};

/** A sweep of sweep_algorithms.hpp as exact witness.
    @param change  called as change(model, number) on each model before it is used: nothing for the
                   witness itself; tests plant their errors here */
template <typename Algorithm, typename Change>
ExactWitness sweepWitness(const scene::Scene& scene, Change change) {
  const auto on = [mechanism = scene.mechanism, change](const auto& number) {
    using Numbers = std::decay_t<decltype(number)>;
    using T = typename Numbers::Scalar;
    Setup<T> setup(mechanism, number);
    change(setup.model, number);
    for (Setup<T>& kept : setup.with_fixed_joints) change(kept.model, number);
    return [setup](Quantity quantity, const scene::State<T>& state) mutable {
      return MatrixOf<T>(Algorithm::answer(setup, quantity, state));
    };
  };
  return {Algorithm::kName, Algorithm::answers, on, on};
}

/// Lagrange's equations link by link, with the same `change` on its HomogeneousModel.
template <typename Change>
ExactWitness recursiveLagrangeWitness(const scene::Scene& scene, Change change) {
  const auto on = [mechanism = scene.mechanism, change](const auto& number) {
    using T = typename std::decay_t<decltype(number)>::Scalar;
    RecursiveLagrange<T> witness(mechanism, number);
    change(witness.model, number);
    return witness;
  };
  return {RecursiveLagrange<PrimeField>::kName, RecursiveLagrange<PrimeField>::answers, on, on};
}

/// The programs that the scene's kernel is compiled from (smallestRoad), for the parameters as
/// written.
ExactWitness kernelWitness(const scene::Scene& scene);

/// lagrange (derived here, once), newton_euler, composite_body, articulated_body,
/// recursive_lagrange, fast and, where the parameters are as written and there is one, kernel; or
/// those of them that `names` names.
std::vector<ExactWitness> exactWitnesses(const scene::Scene& scene, Parameters parameters,
                                         const std::vector<std::string>& names = {});

/// The comparisons alone, of witnesses of the caller's choice.
std::vector<CheckResult> compareExactly(const scene::Scene& scene,
                                        const std::vector<ExactWitness>& witnesses,
                                        const ExactOptions& options);
/// The identities alone.
std::vector<CheckResult> checkIdentitiesExactly(const scene::Scene& scene,
                                                const ExactOptions& options);
/// phi, J and (dJ/dt) qd of the closures, by lagrange and by the sweeps; none without closures.
/// @param derived  what Lagrange's side is derived from instead of the scene: tests plant their
///   errors there
std::vector<CheckResult> checkClosuresExactly(const scene::Scene& scene,
                                              const ExactOptions& options,
                                              const scene::Mechanism* derived = nullptr);

/// What of the constrained motion the scene has to show: closures, driven joints, acceleration
/// constraints. No checks where it has none of them; `derived` as above.
std::vector<CheckResult> checkConstrainedExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const scene::Mechanism* derived = nullptr);

/// "residual zero at 2 points modulo 63-bit primes; chance that different formulas pass at most
/// 3e-34"
std::string describeExact(const CheckResult::Exact& exact);

}  // namespace dynwitness::crosscheck
