// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors and symmetric matrices whose entries are expressions.
#pragma once

#include <array>

#include "symbolic/graph.hpp"

namespace dynwitness::symbolic {

inline Value constant(Graph* graph, const Rational& r) {
  return {graph, graph->constant(r)};
}
inline Value input(Graph* graph, Input kind, int index) {
  return {graph, graph->input(kind, index)};
}

using Vector3 = std::array<Value, 3>;

inline Vector3 operator+(const Vector3& a, const Vector3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vector3 operator*(Value s, const Vector3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
inline Value dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vector3 zeroVector(Graph* graph) {
  const Value zero = constant(graph, 0);
  return {zero, zero, zero};
}

/// A symmetric matrix; (i, j) and (j, i) are one entry.
struct Symmetric {
  Value xx, yy, zz, xy, xz, yz;

  Value& operator()(int i, int j) {
    if (i == j) return i == 0 ? xx : i == 1 ? yy : zz;
    return i + j == 1 ? xy : i + j == 2 ? xz : yz;
  }
  const Value& operator()(int i, int j) const { return const_cast<Symmetric&>(*this)(i, j); }
};

inline Symmetric operator+(const Symmetric& a, const Symmetric& b) {
  return {a.xx + b.xx, a.yy + b.yy, a.zz + b.zz, a.xy + b.xy, a.xz + b.xz, a.yz + b.yz};
}
inline Vector3 column(const Symmetric& m, int j) {
  return {m(0, j), m(1, j), m(2, j)};
}
inline Symmetric zeroMatrix(Graph* graph) {
  const Value zero = constant(graph, 0);
  return {zero, zero, zero, zero, zero, zero};
}

}  // namespace dynwitness::symbolic
