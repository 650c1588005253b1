// SPDX-License-Identifier: GPL-3.0-or-later
// The range in which squares of what a user gives keep their digits.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/studies/flow.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck {

/** What squares are multiplied with beside, at most: the largest and the inverse of the smallest
    diagonal entry of M, and 1. */
inline double weightOf(const recursive::MatrixX<double>& M) {
  double weight = 1;
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    weight = std::max({weight, M(i, i), M(i, i) > 0 ? 1 / M(i, i) : 1});
  return weight;
}

/// The same at these positions.
inline double weightsAt(const recursive::Model<double>& model, const std::vector<double>& slots) {
  recursive::Workspace<double> ws(model);
  recursive::MatrixX<double> M(model.dof(), model.dof());
  recursive::massMatrix(model, slotPositions(slots), ws, M);
  return weightOf(M);
}

/** A number x is 0, or its square and the square's rounding are normal numbers, also times or by
    the square of a weight w: |x| from 2^-484 w to 2^484 / w, since (2^-484)^2 2^-53 > 2^-1022.
    Below, a double has no relative precision, and a limit of rounding would let everything pass;
    above, sums of squares have as much room to infinity.
    @throws scene::InputError  naming the first number outside, and the range */
template <typename Values>
void requireSquares(const char* what, const Values& values, double weight = 1) {
  const double low = std::ldexp(weight, -484), high = std::ldexp(1 / weight, 484);
  for (const double x : values)
    if (x != 0 && !(std::abs(x) >= low && std::abs(x) <= high))
      throw scene::InputError(
          {},
          fmt::format("{} is {}, allowed: 0, and {:.3g} to {:.3g} of either sign, whose squares "
                      "keep their digits in energies of this mechanism",
                      what, x, low, high));
}

}  // namespace dynwitness::crosscheck
