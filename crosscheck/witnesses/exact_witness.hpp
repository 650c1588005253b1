// SPDX-License-Identifier: GPL-3.0-or-later
// What a witness is that computes in any arithmetic.
#pragma once

#include <functional>
#include <string>
#include <type_traits>

#include "crosscheck/scalars/degree.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/** A witness in any arithmetic: built with a scene's numbers once, then asked at many states.

    A sweep or a derived program is one template, run in the field for its answers and in
    DegreeBound for the size of its formulas; so both ways are made of the same code. */
struct ExactWitness {
  template <typename T>
  using Answers = std::function<MatrixOf<T>(Quantity, const scene::State<T>&)>;

  std::string name;
  std::function<bool(Quantity)> answers;
  std::function<Answers<PrimeField>(const FieldNumbers&)> in_field;
  std::function<Answers<DegreeBound>(const DegreeNumbers&)> in_degrees;
  bool is_control = false;  ///< too heavy by design (exact/control_in_field.hpp)
};

/** A sweep of sweep_algorithms.hpp.
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
