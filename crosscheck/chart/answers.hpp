// SPDX-License-Identifier: GPL-3.0-or-later
// From a method's scalar to balls, without any rounding.
#pragma once

#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"

namespace dynwitness::crosscheck {

template <typename T>
Ball exactly(const T& x) {
  return Ball(x);
}

template <typename T>
MatrixX<Ball> exactlyAll(const MatrixX<T>& m) {
  const BallPrecision precision(400);  // the longest mantissa, that of 50 digits, has 168 bits
  return m.unaryExpr([](const T& x) { return exactly(x); });
}

}  // namespace dynwitness::crosscheck
