// SPDX-License-Identifier: GPL-3.0-or-later
// What a witness is that computes in any arithmetic.
#pragma once

#include <functional>
#include <string>
#include <type_traits>

#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/** A witness over the prime field: built with a scene's numbers, then asked at states; in the scope
    of FormulaSizes for the size of its formulas, else for their values. */
struct ExactWitness {
  using Answers = std::function<MatrixOf<PrimeField>(Quantity, const scene::State<PrimeField>&)>;

  std::string name;
  std::function<bool(Quantity)> answers;
  std::function<Answers(const FieldNumbers&)> in_field;
  bool is_control = false;  ///< too heavy by design (exact/control_in_field.hpp)
};

/** A sweep of sweep_algorithms.hpp.
    @param change  called as change(model, number) on each model before it is used: nothing for the
                   witness itself; tests plant their errors here */
template <typename Algorithm, typename Change>
ExactWitness sweepWitness(const scene::Scene& scene, Change change) {
  const auto on = [mechanism = scene.mechanism, change](const FieldNumbers& number) {
    using T = PrimeField;
    Setup<T> setup(mechanism, number);
    change(setup.model, number);
    for (Setup<T>& kept : setup.with_fixed_joints) change(kept.model, number);
    return [setup](Quantity quantity, const scene::State<T>& state) mutable {
      return MatrixOf<T>(Algorithm::answer(setup, quantity, state));
    };
  };
  return {Algorithm::kName, Algorithm::answers, on};
}

/// Lagrange's equations link by link, with the same `change` on its HomogeneousModel.
template <typename Change>
ExactWitness recursiveLagrangeWitness(const scene::Scene& scene, Change change) {
  const auto on = [mechanism = scene.mechanism, change](const FieldNumbers& number) {
    RecursiveLagrange<PrimeField> witness(mechanism, number);
    change(witness.model, number);
    return witness;
  };
  return {RecursiveLagrange<PrimeField>::kName, RecursiveLagrange<PrimeField>::answers, on};
}

// What the kinds of witnesses.hpp make: WitnessKind::make_exact.
OrRefusal<ExactWitness> exactLagrange(const PreparedScene& scene, Parameters parameters);
OrRefusal<ExactWitness> exactNewtonEuler(const PreparedScene& scene, Parameters parameters);
OrRefusal<ExactWitness> exactCompositeBody(const PreparedScene& scene, Parameters parameters);
OrRefusal<ExactWitness> exactArticulatedBody(const PreparedScene& scene, Parameters parameters);
OrRefusal<ExactWitness> exactRecursiveLagrange(const PreparedScene& scene, Parameters parameters);
OrRefusal<ExactWitness> exactFast(const PreparedScene& scene, Parameters parameters);
/// The programs that the scene's kernel is compiled from, for the parameters as written.
OrRefusal<ExactWitness> exactKernel(const PreparedScene& scene, Parameters parameters);

}  // namespace dynwitness::crosscheck
