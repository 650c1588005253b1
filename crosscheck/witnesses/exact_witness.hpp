// SPDX-License-Identifier: GPL-3.0-or-later
// What a witness is that computes in any arithmetic.
#pragma once

#include <functional>
#include <string>

#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/** A witness over the prime field: built with a scene's numbers, then asked at states; in the scope
    of FormulaSizes for the size of its formulas, else for their values. */
struct ExactWitness {
  using Answers = std::function<MatrixX<PrimeField>(Quantity, const scene::State<PrimeField>&)>;

  std::string name;
  std::function<bool(Quantity)> answers;
  std::function<Answers(const FieldNumbers&)> in_field;
  bool is_control = false;  ///< too heavy by design (exact/control_in_field.hpp)
};

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
