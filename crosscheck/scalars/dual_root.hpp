// SPDX-License-Identifier: GPL-3.0-or-later
// What springs between points ask of dual numbers over balls: roots, and whether a length is none.
#pragma once

#include <cmath>

#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/dual.hpp"

namespace dynwitness::crosscheck {

/// Every number in a is greater than every number in b.
inline bool operator>(const Ball& a, const Ball& b) {
  return (a - b).isPositive();
}
/// Of the values: between jumps a derivative has no say.
template <typename T>
bool operator>(const Dual<T>& a, const Dual<T>& b) {
  return a.value > b.value;
}

/// sqrt(a + b eps) = sqrt(a) + b / (2 sqrt(a)) eps
template <typename T>
Dual<T> sqrt(const Dual<T>& a) {
  using std::sqrt;
  const T root = sqrt(a.value);
  return {root, a.derivative / (root + root)};
}

}  // namespace dynwitness::crosscheck
