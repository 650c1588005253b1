// SPDX-License-Identifier: GPL-3.0-or-later
// What a witness is that computes in any arithmetic.
#pragma once

#include <functional>
#include <string>

#include "crosscheck/scalars/degree.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
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

}  // namespace dynwitness::crosscheck
