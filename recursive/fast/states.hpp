// SPDX-License-Identifier: Apache-2.0
// Many states side by side: a scalar of which each state has its own, in one vector register.
#pragma once

#include <cmath>
#include <cstring>

#include "recursive/fast/plan.hpp"
#include "recursive/fast/sine_cosine.hpp"

namespace dynwitness::recursive::fast {

namespace detail {
/// N doubles in a register. Their alignment is said: g++ else takes it from the processor that a
/// function is compiled for, and an object's from another.
template <int N>
struct Register;
template <>
struct Register<2> {
  typedef double Vector __attribute__((vector_size(16), aligned(16)));
  typedef long long Bits __attribute__((vector_size(16), aligned(16)));
};
template <>
struct Register<4> {
  typedef double Vector __attribute__((vector_size(32), aligned(32)));
  typedef long long Bits __attribute__((vector_size(32), aligned(32)));
};
template <>
struct Register<8> {
  typedef double Vector __attribute__((vector_size(64), aligned(64)));
  typedef long long Bits __attribute__((vector_size(64), aligned(64)));
};
}  // namespace detail

/// A number of each of N states. What is done to it is done to each, with the same roundings.
template <int N>
struct States {
  using Vector = typename detail::Register<N>::Vector;
  Vector v;

  States() = default;
  /// The same number in each. By its bits, which g++ 12 spreads in one instruction; of doubles it
  /// makes one a lane where the caller is compiled for a wider processor than this function.
  DYNWITNESS_INLINE States(double x) {  // NOLINT(google-explicit-constructor)
    long long bits;
    std::memcpy(&bits, &x, sizeof bits);
    v = (Vector)(bits - typename detail::Register<N>::Bits{});
  }
  DYNWITNESS_INLINE explicit States(const Vector& of) : v(of) {}

  DYNWITNESS_INLINE States operator-() const { return States(-v); }
  friend DYNWITNESS_INLINE States operator+(const States& a, const States& b) {
    return States(a.v + b.v);
  }
  friend DYNWITNESS_INLINE States operator-(const States& a, const States& b) {
    return States(a.v - b.v);
  }
  friend DYNWITNESS_INLINE States operator*(const States& a, const States& b) {
    return States(a.v * b.v);
  }
  friend DYNWITNESS_INLINE States operator/(const States& a, const States& b) {
    return States(a.v / b.v);
  }
  DYNWITNESS_INLINE States& operator+=(const States& b) {
    v += b.v;
    return *this;
  }
};

/// As of a single state:
///     friction(qd) = viscous qd, + positive where qd > 0, - negative where qd < 0.
template <int N>
DYNWITNESS_INLINE States<N> frictionForce(const Link<double>& link, const States<N>& rate) {
  using S = States<N>;
  const auto forward = rate.v > S(0).v, backward = rate.v < S(0).v;
  S force = link.viscous * rate;
  force.v = forward ? (force + link.positive).v : force.v;
  force.v = backward ? (force - link.negative).v : force.v;
  return force;
}

namespace detail {
#ifdef __x86_64__
// eight sines and cosines; two and four are sine_cosine.hpp's
#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), \
                             apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512vl")
#pragma GCC optimize("fp-contract=off")
#endif
namespace eight {
typedef double V __attribute__((vector_size(64)));
typedef long long I __attribute__((vector_size(64)));
enum { LANES = 8 };
// NOLINTBEGIN(readability-duplicate-include): once for each width of vectors
#include "recursive/fast/sine_cosine.inc"
#include "recursive/fast/sine_cosine_positions.inc"
// NOLINTEND(readability-duplicate-include)
}  // namespace eight
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

inline void sineCosine(const States<2>& angle, States<2>& sine, States<2>& cosine) {
  two::ofAny(angle.v, &sine.v, &cosine.v);
}
#ifdef __x86_64__
DYNWITNESS_FOR_AVX2 inline void sineCosine(const States<4>& angle, States<4>& sine,
                                           States<4>& cosine) {
  four::ofAny(angle.v, &sine.v, &cosine.v);
}
DYNWITNESS_FOR_AVX512 inline void sineCosine(const States<8>& angle, States<8>& sine,
                                             States<8>& cosine) {
  eight::ofAny(angle.v, &sine.v, &cosine.v);
}
#endif

/// Nine numbers that are read by row and column.
template <typename T>
struct NineNumbers {
  T entry[3][3];
  DYNWITNESS_INLINE const T& operator()(int i, int j) const { return entry[i][j]; }
};

/// Whether a quaternion's square is a normal number in each state: no power of two is needed then.
template <int N>
DYNWITNESS_INLINE bool areNormal(const States<N>& square) {
  bool all = true;
  for (int lane = 0; lane < N; ++lane) all = all && std::isnormal(square.v[lane]);
  return all;
}

/// Rotations by recursive::rotation(), lane by lane. Not inlined, so that it is compiled for the
/// processor that the rest of the program is for, and gives the same bits.
template <int N>
__attribute__((noinline)) void rotationsByLanes(const JointPosition<States<N>>* x,
                                                NineNumbers<States<N>>& R) {
  for (int lane = 0; lane < N; ++lane) {
    JointPosition<double> one[4];
    for (int k = 0; k < 4; ++k) one[k] = {x[k].q.v[lane], 0, 0};
    const Matrix3<double> of_one = recursive::rotation(one);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) R.entry[i][j].v[lane] = of_one(i, j);
  }
}
}  // namespace detail

/// As recursive::rotation() of each state.
template <int N>
DYNWITNESS_INLINE detail::NineNumbers<States<N>> rotation(const JointPosition<States<N>>* at) {
  using S = States<N>;
  const S w = at[0].q, x = at[1].q, y = at[2].q, z = at[3].q;
  const S ww = w * w, xx = x * x, yy = y * y, zz = z * z;
  if (!detail::areNormal<N>(S(0) + ww + xx + yy + zz)) {
    detail::NineNumbers<S> R;
    detail::rotationsByLanes<N>(at, R);
    return R;
  }
  const S scale = S(2) / (ww + ((xx + yy) + zz)), one(1), zero(0);
  return {
      {{one + (-zz - yy) * scale, zero + (x * y - z * w) * scale, zero + (x * z + y * w) * scale},
       {zero + (x * y + z * w) * scale, one + (-zz - xx) * scale, zero + (y * z - x * w) * scale},
       {zero + (x * z - y * w) * scale, zero + (y * z + x * w) * scale, one + (-yy - xx) * scale}}};
}

}  // namespace dynwitness::recursive::fast
