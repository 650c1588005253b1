// SPDX-License-Identifier: Apache-2.0
// Plain vectors and matrices for the fast sweeps: three numbers and nothing else, so that a
// compiler keeps them in registers. spatial.hpp is the readable algebra; this is what its sweeps
// boil down to.
#pragma once

#include <type_traits>
#include <utility>

#include "recursive/spatial.hpp"

namespace dynwitness::recursive::fast {

/// Inlined where it stands, whatever its size: one step of a sweep is straight code.
#define DYNWITNESS_INLINE inline __attribute__((always_inline))
#define DYNWITNESS_INLINE_LAMBDA __attribute__((always_inline))

template <typename T>
struct Vec {
  T x, y, z;

  static Vec zero() { return {T(0), T(0), T(0)}; }
  static Vec from(const Vector3<T>& v) { return {v.x(), v.y(), v.z()}; }
  Vec operator+(const Vec& b) const { return {x + b.x, y + b.y, z + b.z}; }
  Vec operator-(const Vec& b) const { return {x - b.x, y - b.y, z - b.z}; }
  Vec operator*(const T& s) const { return {x * s, y * s, z * s}; }
};

/** A constant of a mechanism (a number, Vec, Mat or Symmetric3 of type P) where states of type T
    meet it: itself, or, where T holds many states, the same in each. */
template <typename T, typename P>
DYNWITNESS_INLINE decltype(auto) in(const P& x) {
  if constexpr (std::is_same_v<T, P>)
    return static_cast<const T&>(x);
  else
    return T(x);
}
template <typename T, typename P>
DYNWITNESS_INLINE decltype(auto) in(const Vec<P>& v) {
  if constexpr (std::is_same_v<T, P>)
    return static_cast<const Vec<T>&>(v);
  else
    return Vec<T>{T(v.x), T(v.y), T(v.z)};
}
template <typename T, typename P>
DYNWITNESS_INLINE decltype(auto) in(const Symmetric3<P>& m) {
  if constexpr (std::is_same_v<T, P>)
    return static_cast<const Symmetric3<T>&>(m);
  else
    return Symmetric3<T>{T(m.xx), T(m.yy), T(m.zz), T(m.xy), T(m.xz), T(m.yz)};
}

template <typename T>
DYNWITNESS_INLINE Vec<T> cross(const Vec<T>& a, const Vec<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Rows of a 3 x 3 matrix.
template <typename T>
struct Mat {
  T xx, xy, xz, yx, yy, yz, zx, zy, zz;

  static Mat from(const Matrix3<T>& m) {
    return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
  }
};

template <typename T, typename P>
DYNWITNESS_INLINE decltype(auto) in(const Mat<P>& m) {
  if constexpr (std::is_same_v<T, P>)
    return static_cast<const Mat<T>&>(m);
  else
    return Mat<T>{T(m.xx), T(m.xy), T(m.xz), T(m.yx), T(m.yy), T(m.yz), T(m.zx), T(m.zy), T(m.zz)};
}

template <typename T>
DYNWITNESS_INLINE Vec<T> times(const Mat<T>& m, const Vec<T>& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.yx * v.x + m.yy * v.y + m.yz * v.z,
          m.zx * v.x + m.zy * v.y + m.zz * v.z};
}
/// m' v
template <typename T>
DYNWITNESS_INLINE Vec<T> transposedTimes(const Mat<T>& m, const Vec<T>& v) {
  return {m.xx * v.x + m.yx * v.y + m.zx * v.z, m.xy * v.x + m.yy * v.y + m.zy * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}
template <typename T>
DYNWITNESS_INLINE Vec<T> times(const Symmetric3<T>& m, const Vec<T>& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

// ---- turns in a coordinate plane ----------------------------------------------------------------
//
// A vector's components (a, b) become (c a - s b, s a + c b). A matrix is turned from both sides.
// What is turned may be many states' (States), by an angle that is the same in all of them.
// Every new entry is a sum of products of old ones: shorter formulas exist (they use c^2 + s^2 =
// 1), but they cancel, and lose the digits of a light direction beside a heavy one.

template <typename C, typename T>
DYNWITNESS_INLINE void turn(const C& c, const C& s, T& a, T& b) {
  const T new_a = c * a - s * b;
  b = s * a + c * b;
  a = new_a;
}

/// The symmetric matrix [aa ab at; ab bb bt; at bt tt] in the plane of a and b.
template <typename C, typename T>
DYNWITNESS_INLINE void turn(const C& c, const C& s, T& aa, T& bb, T& ab, T& at, T& bt) {
  const T ca = c * aa - s * ab, cb = c * ab - s * bb;
  const T sa = s * aa + c * ab, sb = s * ab + c * bb;
  aa = c * ca - s * cb;
  ab = s * ca + c * cb;
  bb = s * sa + c * sb;
  turn(c, s, at, bt);
}

template <typename C, typename T>
DYNWITNESS_INLINE void turnAboutZ(const C& c, const C& s, Vec<T>& v) {
  turn(c, s, v.x, v.y);
}
template <typename C, typename T>
DYNWITNESS_INLINE void turnAboutX(const C& c, const C& s, Vec<T>& v) {
  turn(c, s, v.y, v.z);
}
template <typename C, typename T>
DYNWITNESS_INLINE void turnAboutZ(const C& c, const C& s, Symmetric3<T>& m) {
  turn(c, s, m.xx, m.yy, m.xy, m.xz, m.yz);
}
template <typename C, typename T>
DYNWITNESS_INLINE void turnAboutX(const C& c, const C& s, Symmetric3<T>& m) {
  turn(c, s, m.yy, m.zz, m.yz, m.xy, m.xz);
}
template <typename C, typename T>
DYNWITNESS_INLINE void turnAboutZ(const C& c, const C& s, Mat<T>& m) {
  turn(c, s, m.xx, m.yx);
  turn(c, s, m.xy, m.yy);
  turn(c, s, m.xz, m.yz);
  turn(c, s, m.xx, m.xy);
  turn(c, s, m.yx, m.yy);
  turn(c, s, m.zx, m.zy);
}
template <typename C, typename T>
DYNWITNESS_INLINE void turnAboutX(const C& c, const C& s, Mat<T>& m) {
  turn(c, s, m.yx, m.zx);
  turn(c, s, m.yy, m.zy);
  turn(c, s, m.yz, m.zz);
  turn(c, s, m.xy, m.xz);
  turn(c, s, m.yy, m.yz);
  turn(c, s, m.zy, m.zz);
}

// a quarter turn about x, s = 1 or -1: (y, z) becomes (-s z, s y), without a product of two
// unknowns
template <typename C, typename T>
DYNWITNESS_INLINE void quarterAboutX(const C& s, Vec<T>& v) {
  const T y = -(s * v.z);
  v.z = s * v.y;
  v.y = y;
}
template <typename C, typename T>
DYNWITNESS_INLINE void quarterAboutX(const C& s, Symmetric3<T>& m) {
  std::swap(m.yy, m.zz);
  m.yz = -m.yz;
  const T xy = -(s * m.xz);
  m.xz = s * m.xy;
  m.xy = xy;
}
template <typename C, typename T>
DYNWITNESS_INLINE void quarterAboutX(const C& s, Mat<T>& m) {
  std::swap(m.yy, m.zz);
  const T yz = -m.zy;
  m.zy = -m.yz;
  m.yz = yz;
  const T xy = -(s * m.xz), yx = -(s * m.zx);
  m.xz = s * m.xy;
  m.zx = s * m.yx;
  m.xy = xy;
  m.yx = yx;
}

/// R' m R from both sides, for any R.
template <typename T>
DYNWITNESS_INLINE void turnBack(const Mat<T>& R, Mat<T>& m) {
  const Vec<T> x = transposedTimes(R, Vec<T>{m.xx, m.yx, m.zx});
  const Vec<T> y = transposedTimes(R, Vec<T>{m.xy, m.yy, m.zy});
  const Vec<T> z = transposedTimes(R, Vec<T>{m.xz, m.yz, m.zz});
  const Vec<T> a = transposedTimes(R, Vec<T>{x.x, y.x, z.x});
  const Vec<T> b = transposedTimes(R, Vec<T>{x.y, y.y, z.y});
  const Vec<T> c = transposedTimes(R, Vec<T>{x.z, y.z, z.z});
  m = {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
}
template <typename T>
DYNWITNESS_INLINE void turnBack(const Mat<T>& R, Symmetric3<T>& m) {
  // columns of m R, then the upper half of R' (m R)
  const Vec<T> x = times(m, Vec<T>{R.xx, R.yx, R.zx}), y = times(m, Vec<T>{R.xy, R.yy, R.zy}),
               z = times(m, Vec<T>{R.xz, R.yz, R.zz});
  m = {R.xx * x.x + R.yx * x.y + R.zx * x.z, R.xy * y.x + R.yy * y.y + R.zy * y.z,
       R.xz * z.x + R.yz * z.y + R.zz * z.z, R.xx * y.x + R.yx * y.y + R.zx * y.z,
       R.xx * z.x + R.yx * z.y + R.zx * z.z, R.xy * z.x + R.yy * z.y + R.zy * z.z};
}

}  // namespace dynwitness::recursive::fast
