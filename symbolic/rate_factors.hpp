// SPDX-License-Identifier: GPL-3.0-or-later
// Quadratic forms as products of two linear ones, over the rational numbers.
#pragma once

#include <map>
#include <optional>
#include <utility>

#include "scene/expression.hpp"

namespace dynwitness::symbolic {

using LinearForm = std::map<int, scene::Rational>;  ///< variable -> coefficient, none of them 0
/// (i, j), i <= j -> coefficient of x_i x_j, none of them 0
using QuadraticForm = std::map<std::pair<int, int>, scene::Rational>;

/** Q = L1 L2, where there are such forms with rational coefficients. With a square a x^2 in Q,

        Q = a x^2 + x L + R = ((2 a x + L)^2 - D) / (4 a),   D = L^2 - 4 a R

    and D has to be the square of a linear form; without any square x has to be a factor of one of
    the two,  Q = x L + R = L (x + K)  with R = L K.
    @return  L1 with 1 as the greatest common divisor of whole coefficients and a positive first
      one; empty: no such forms */
std::optional<std::pair<LinearForm, LinearForm>> linearFactors(const QuadraticForm& Q);

}  // namespace dynwitness::symbolic
