// SPDX-License-Identifier: GPL-3.0-or-later
// Our sweeps and recursive Lagrange as witnesses over the prime field.
#pragma once

#include "crosscheck/witnesses/exact_witness.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {

/** A sweep of sweep_algorithms.hpp.
    @param change  called as change(model, number) on each model before it is used: nothing for the
                   witness itself; tests plant their errors here */
template <typename Algorithm, typename Change>
ExactWitness sweepWitness(const scene::Scene& scene, Change change) {
  const auto on = [mechanism = scene.mechanism, change](const FieldNumbers& number) {
    using T = PrimeField;
    Setup<T> setup(recursive::buildModel(mechanism, number));
    if (Algorithm::answers(Quantity::kReactions) && setup.isLumped())
      setup.with_fixed_joints.emplace_back(
          recursive::buildModel(mechanism, number, recursive::FixedJoints::kKept));
    change(setup.model, number);
    for (Setup<T>& kept : setup.with_fixed_joints) change(kept.model, number);
    return [setup](Quantity quantity, const scene::State<T>& state) mutable {
      return MatrixX<T>(Algorithm::answer(setup, quantity, state));
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

}  // namespace dynwitness::crosscheck
