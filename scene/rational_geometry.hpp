// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors and symmetric matrices of rationals: decisions about numbers on the border of what is
// possible (a thin rod: one principal moment is zero, the other two are equal) fall on its right
// side.
#pragma once

#include <array>

#include "scene/expression.hpp"

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

/// Whether a symmetric matrix has no negative eigenvalue: all seven principal minors are >= 0.
inline bool isPositiveSemidefinite(const RationalMatrix& m) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (m[i][i] < 0 || m[i][i] * m[j][j] < m[i][j] * m[j][i]) return false;
  }
  return dot(m[0], cross(m[1], m[2])) >= 0;
}

/** Some distribution of mass has this inertia about its centre: I >= 0 and J = tr(I)/2 1 - I >= 0.
    J is the triangle inequality: its eigenvalues are half of two moments less the third. */
inline bool isRealizable(const RationalMatrix& inertia, const Rational& allowance,
                         bool* is_positive) {
  const Rational trace = inertia[0][0] + inertia[1][1] + inertia[2][2];
  RationalMatrix I = inertia, J = inertia;
  for (std::size_t i = 0; i < 3; ++i) {
    for (Rational& element : J[i]) element = -element;
    J[i][i] += trace / 2 + allowance;
    I[i][i] += allowance;
  }
  *is_positive = isPositiveSemidefinite(I);
  return *is_positive && isPositiveSemidefinite(J);
}

}  // namespace dynwitness::scene
