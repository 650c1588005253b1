// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors and symmetric matrices of rationals: decisions about numbers on the border of what is
// possible (a thin rod: one principal moment is zero, the other two are equal) fall on its right
// side.
#pragma once

#include <array>

#include "scene/rational_signs.hpp"

namespace dynwitness::scene {

using RationalVector = std::array<Rational, 3>;
using RationalMatrix = std::array<RationalVector, 3>;

inline Rational dot(const RationalVector& a, const RationalVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline RationalVector cross(const RationalVector& a, const RationalVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline RationalVector operator*(const RationalMatrix& m, const RationalVector& v) {
  return {dot(m[0], v), dot(m[1], v), dot(m[2], v)};
}

inline RationalMatrix transpose(const RationalMatrix& m) {
  RationalMatrix t;
  for (std::size_t i = 0; i < 3; ++i) t[i] = {m[0][i], m[1][i], m[2][i]};
  return t;
}

inline RationalMatrix operator*(const RationalMatrix& a, const RationalMatrix& b) {
  const RationalMatrix columns = transpose(b);
  RationalMatrix product;
  for (std::size_t i = 0; i < 3; ++i) product[i] = columns * a[i];
  return product;
}

inline RationalMatrix identity() {
  return {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

using IntegerMatrix = std::array<std::array<Integer, 3>, 3>;

/// The least common multiple of a rational's denominator and another number, above zero.
inline Integer commonDenominator(const Integer& other, const Rational& x) {
  return other % bottom(x) == 0 ? other : Integer(lcm(other, bottom(x)));
}
/// times a multiple of its denominator
inline Integer scaledBy(const Integer& multiple, const Rational& x) {
  return top(x) * (multiple / bottom(x));
}

/// Whether a symmetric matrix has no negative eigenvalue: all seven principal minors are >= 0.
inline bool isPositiveSemidefinite(const IntegerMatrix& m) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (m[i][i] < 0 || m[i][i] * m[j][j] < m[i][j] * m[j][i]) return false;
  }
  const auto minor = [&](std::size_t j, std::size_t k) {
    return Integer(m[1][j] * m[2][k] - m[1][k] * m[2][j]);
  };
  return m[0][0] * minor(1, 2) + m[0][1] * minor(2, 0) + m[0][2] * minor(0, 1) >= 0;
}
/// m times a common denominator, of which *common, which is made one, is a divisor before.
inline IntegerMatrix inWholeNumbers(const RationalMatrix& m, Integer* common) {
  for (const RationalVector& row : m)
    for (const Rational& element : row) *common = commonDenominator(*common, element);
  IntegerMatrix scaled;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) scaled[i][j] = scaledBy(*common, m[i][j]);
  return scaled;
}
/// A common denominator changes no sign, and integers need no lowest terms.
inline bool isPositiveSemidefinite(const RationalMatrix& m) {
  Integer common = 1;
  return isPositiveSemidefinite(inWholeNumbers(m, &common));
}

/** Some distribution of mass has this inertia about its centre: I >= 0 and J = tr(I)/2 1 - I >= 0.
    J is the triangle inequality: its eigenvalues are half of two moments less the third. Both may
    be multiplied by the same number above zero. */
inline bool isRealizable(IntegerMatrix I, const Integer& allowance, bool* is_positive) {
  const Integer trace = I[0][0] + I[1][1] + I[2][2];
  IntegerMatrix J;  // twice as much
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) J[i][j] = -2 * I[i][j];
  for (std::size_t i = 0; i < 3; ++i) {
    J[i][i] += trace + 2 * allowance;
    I[i][i] += allowance;
  }
  *is_positive = isPositiveSemidefinite(I);
  return *is_positive && isPositiveSemidefinite(J);
}
inline bool isRealizable(const RationalMatrix& inertia, const Rational& allowance,
                         bool* is_positive) {
  Integer common = commonDenominator(1, allowance);
  const IntegerMatrix I = inWholeNumbers(inertia, &common);
  return isRealizable(I, scaledBy(common, allowance), is_positive);
}

}  // namespace dynwitness::scene
