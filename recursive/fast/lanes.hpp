// SPDX-License-Identifier: Apache-2.0
// Four numbers side by side, on any scalar and in the vector registers of a processor.
#pragma once

#include <cstddef>

#include "recursive/fast/vector.hpp"

namespace dynwitness::recursive::fast {

/// How many columns are carried inward together.
inline constexpr int kBlock = 4;

/// As many numbers as a block has columns, side by side, on any scalar.
template <typename T>
struct Lanes {
  static constexpr int kCount = kBlock;
  T v[kBlock];

  static Lanes load(const T* from) { return {{from[0], from[1], from[2], from[3]}}; }
  /// Zero before the first lane.
  static Lanes loadFrom(int first, const T* from) {
    Lanes a = load(from);
    for (int i = 0; i < first; ++i) a.v[i] = T(0);
    return a;
  }
  void store(T* to) const {
    for (int i = 0; i < kBlock; ++i) to[i] = v[i];
  }
  /// One by one, this many numbers apart.
  void scatter(T* to, std::size_t apart) const {
    for (int i = 0; i < kBlock; ++i) to[i * apart] = v[i];
  }
  void scatterThree(T* to, std::size_t apart) const {
    for (int i = 0; i < 3; ++i) to[i * apart] = v[i];
  }
  Lanes operator+(const Lanes& b) const {
    return {{v[0] + b.v[0], v[1] + b.v[1], v[2] + b.v[2], v[3] + b.v[3]}};
  }
  Lanes operator-(const Lanes& b) const {
    return {{v[0] - b.v[0], v[1] - b.v[1], v[2] - b.v[2], v[3] - b.v[3]}};
  }
  Lanes operator-() const { return {{-v[0], -v[1], -v[2], -v[3]}}; }
  Lanes operator*(const Lanes& b) const {
    return {{v[0] * b.v[0], v[1] * b.v[1], v[2] * b.v[2], v[3] * b.v[3]}};
  }
  friend Lanes operator*(const T& s, const Lanes& b) {
    return {{s * b.v[0], s * b.v[1], s * b.v[2], s * b.v[3]}};
  }
  /// Of the first three; the last is zero.
  friend Lanes cross(const Lanes& a, const Lanes& b) {
    return {{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2],
             a.v[0] * b.v[1] - a.v[1] * b.v[0], T(0)}};
  }
};

/// One column of a block, where a number is a vector of many states and four would not stay in
/// registers: what is done to it is what is done to a lane of the others.
template <typename T>
struct One {
  static constexpr int kCount = 1;
  T v;

  static DYNWITNESS_INLINE One load(const T* from) { return {*from}; }
  static DYNWITNESS_INLINE One loadFrom(int first, const T* from) {
    return {first > 0 ? T(0) : *from};
  }
  DYNWITNESS_INLINE void store(T* to) const { *to = v; }
  DYNWITNESS_INLINE One operator+(const One& b) const { return {v + b.v}; }
  DYNWITNESS_INLINE One operator-(const One& b) const { return {v - b.v}; }
  DYNWITNESS_INLINE One operator-() const { return {-v}; }
  DYNWITNESS_INLINE One operator*(const One& b) const { return {v * b.v}; }
  friend DYNWITNESS_INLINE One operator*(const T& s, const One& b) { return {s * b.v}; }
};

/// Calls f(lane) for the lanes of a block, the first that is in use and those after it: each, or
/// once for a pack of all.
template <typename Pack, typename F>
DYNWITNESS_INLINE void forEachLane(int first, const F& f) {
  if constexpr (Pack::kCount == kBlock)
    f(0);
  else
    for (int lane = first; lane < kBlock; ++lane) f(lane);
}

/// The same for double in vector registers of two, which every x86-64 and AArch64 processor has ...
struct TwoPairs {
  static constexpr int kCount = kBlock;
  typedef double Pair __attribute__((vector_size(16)));
  typedef double Memory __attribute__((vector_size(16), aligned(8), may_alias));
  typedef long long Bits __attribute__((vector_size(16)));
  Pair low, high;

  static DYNWITNESS_INLINE TwoPairs load(const double* from) {
    return {*reinterpret_cast<const Memory*>(from), *reinterpret_cast<const Memory*>(from + 2)};
  }
  static DYNWITNESS_INLINE TwoPairs loadFrom(int first, const double* from) {
    const TwoPairs a = load(from);
    // NOLINTNEXTLINE(readability-implicit-bool-conversion): all bits of a lane, or none
    const Bits low = {-(first < 1), -(first < 2)}, high = {-(first < 3), -(first < 4)};
    return {(Pair)((Bits)a.low & low), (Pair)((Bits)a.high & high)};
  }
  DYNWITNESS_INLINE void store(double* to) const {
    *reinterpret_cast<Memory*>(to) = low;
    *reinterpret_cast<Memory*>(to + 2) = high;
  }
  DYNWITNESS_INLINE void scatter(double* to, std::size_t apart) const {
    scatterThree(to, apart);
    to[3 * apart] = high[1];
  }
  DYNWITNESS_INLINE void scatterThree(double* to, std::size_t apart) const {
    to[0] = low[0], to[apart] = low[1], to[2 * apart] = high[0];
  }
  DYNWITNESS_INLINE TwoPairs operator+(const TwoPairs& b) const {
    return {low + b.low, high + b.high};
  }
  DYNWITNESS_INLINE TwoPairs operator-(const TwoPairs& b) const {
    return {low - b.low, high - b.high};
  }
  DYNWITNESS_INLINE TwoPairs operator-() const { return {-low, -high}; }
  DYNWITNESS_INLINE TwoPairs operator*(const TwoPairs& b) const {
    return {low * b.low, high * b.high};
  }
  friend DYNWITNESS_INLINE TwoPairs operator*(double s, const TwoPairs& b) {
    return {s * b.low, s * b.high};
  }
  /// (y, z, x, w)
  DYNWITNESS_INLINE TwoPairs passedOn() const {
    return {__builtin_shufflevector(low, high, 1, 2), __builtin_shufflevector(low, high, 0, 3)};
  }
  friend DYNWITNESS_INLINE TwoPairs cross(const TwoPairs& a, const TwoPairs& b) {
    return (a * b.passedOn() - a.passedOn() * b).passedOn();
  }
};

/// ... and of four.
struct Quad {
  static constexpr int kCount = kBlock;
  typedef double Four __attribute__((vector_size(32)));
  typedef double Memory __attribute__((vector_size(32), aligned(8), may_alias));
  typedef long long Bits __attribute__((vector_size(32)));
  Four v;

  static DYNWITNESS_INLINE Quad load(const double* from) {
    return {*reinterpret_cast<const Memory*>(from)};
  }
  static DYNWITNESS_INLINE Quad loadFrom(int first, const double* from) {
    const Bits lane = {0, 1, 2, 3}, begin = {first, first, first, first};
    return {(Four)((Bits)load(from).v & (lane >= begin))};
  }
  DYNWITNESS_INLINE void store(double* to) const { *reinterpret_cast<Memory*>(to) = v; }
  DYNWITNESS_INLINE void scatter(double* to, std::size_t apart) const {
    scatterThree(to, apart);
    to[3 * apart] = v[3];
  }
  DYNWITNESS_INLINE void scatterThree(double* to, std::size_t apart) const {
    to[0] = v[0], to[apart] = v[1], to[2 * apart] = v[2];
  }
  DYNWITNESS_INLINE Quad operator+(const Quad& b) const { return {v + b.v}; }
  DYNWITNESS_INLINE Quad operator-(const Quad& b) const { return {v - b.v}; }
  DYNWITNESS_INLINE Quad operator-() const { return {-v}; }
  DYNWITNESS_INLINE Quad operator*(const Quad& b) const { return {v * b.v}; }
  friend DYNWITNESS_INLINE Quad operator*(double s, const Quad& b) { return {s * b.v}; }
  /// (y, z, x, w)
  DYNWITNESS_INLINE Quad passedOn() const { return {__builtin_shufflevector(v, v, 1, 2, 0, 3)}; }
  friend DYNWITNESS_INLINE Quad cross(const Quad& a, const Quad& b) {
    return (a * b.passedOn() - a.passedOn() * b).passedOn();
  }
};

}  // namespace dynwitness::recursive::fast
