// SPDX-License-Identifier: GPL-3.0-or-later
// Same mathematics? The comparisons and identities of the crosscheck over a prime field, where a
// residual is zero or it is not.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/scalars/formula_sizes.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

class DerivedPrograms;

struct ExactOptions {
  std::uint64_t seed = 1;
  /// Each check runs at as many points as make the chance that it passes different formulas at most
  /// this.
  double error_probability = 1e-30;
  Parameters parameters = Parameters::kAsWritten;
  /// Those to compare, among them such as do not compute exactly; empty: all. The identities are
  /// laws of our sweeps and hold whoever is compared.
  std::vector<WitnessKind> witnesses = {};
  /// Where not empty, it changes the state of every point: to ask at one state alone.
  std::function<void(const FieldNumbers&, scene::State<PrimeField>&)> at = {};
};

/// The witnesses of these kinds that compute exactly and do not refuse; a kernel is not asked for
/// random parameters.
std::vector<ExactWitness> exactWitnesses(const PreparedScene& scene, Parameters parameters,
                                         const std::vector<WitnessKind>& kinds = witnessKinds());

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

std::vector<CheckResult> checkClosuresExactly(const scene::Scene& scene,
                                              const ExactOptions& options,
                                              const DerivedPrograms& derived);

/// What of the constrained motion the scene has to show: closures, driven joints, acceleration
/// constraints. No checks where it has none of them; `derived` as above.
std::vector<CheckResult> checkConstrainedExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const scene::Mechanism* derived = nullptr);
std::vector<CheckResult> checkConstrainedExactly(const scene::Scene& scene,
                                                 const ExactOptions& options,
                                                 const DerivedPrograms& derived);

/// CheckResult::name() of all exact checks that random mechanisms are asked, each once.
const std::vector<std::string>& exactCheckNames();

/// "residual zero at 2 points modulo 63-bit primes; chance that different formulas pass at most
/// 3e-34"
std::string describeExact(const CheckResult::Exact& exact);

}  // namespace dynwitness::crosscheck
