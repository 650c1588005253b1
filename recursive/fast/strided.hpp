// SPDX-License-Identifier: Apache-2.0
// Arrays of many states as others lay them out, into the lanes of vectors and back; and vectors as
// wide as the processor has them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "recursive/fast/states.hpp"

namespace dynwitness::recursive::fast {

/// Numbers of many states, as NumPy lays them out:
///     number k of state s is at[s * state + k * number].
template <typename T>
struct Strided {
  T* at;
  std::ptrdiff_t state, number = 1;  ///< so many numbers (not bytes) to the next
};

namespace detail {

/// Of a in blocks of D the even ones, of b's even ones in the places of the odd ones; and the rest.
template <int D, typename V, int... k>
DYNWITNESS_INLINE void exchangeBlocks(V& a, V& b, std::integer_sequence<int, k...>) {
  constexpr int N = sizeof...(k);
  const V evens = __builtin_shufflevector(a, b, (k / D % 2 == 0 ? k : N + k - D)...);
  b = __builtin_shufflevector(a, b, (k / D % 2 == 0 ? k + D : N + k)...);
  a = evens;
}
template <int D, int N, typename V>
DYNWITNESS_INLINE void transposeBlocks(V (&rows)[N]) {
  for (int i = 0; i < N; ++i)
    if (i / D % 2 == 0)
      exchangeBlocks<D>(rows[i], rows[i + D], std::make_integer_sequence<int, N>());
  if constexpr (D > 1) transposeBlocks<D / 2>(rows);
}
/// Rows become columns, in registers.
template <int N, typename V>
DYNWITNESS_INLINE void transpose(V (&rows)[N]) {
  transposeBlocks<N / 2>(rows);
}

/// N numbers at any address.
template <int N>
struct Unaligned;
template <>
struct Unaligned<2> {
  typedef double Vector __attribute__((vector_size(16), aligned(8), may_alias));
};
template <>
struct Unaligned<4> {
  typedef double Vector __attribute__((vector_size(32), aligned(8), may_alias));
};
template <>
struct Unaligned<8> {
  typedef double Vector __attribute__((vector_size(64), aligned(8), may_alias));
};

/// Number `number` of the states [first, first + count), count <= N; the last one fills what is
/// left.
template <int N>
DYNWITNESS_INLINE States<N> gather(const Strided<const double>& from, std::size_t first, int count,
                                   int number) {
  States<N> out;
  const double* at =
      from.at + static_cast<std::ptrdiff_t>(first) * from.state + number * from.number;
  for (int lane = 0; lane < N; ++lane) {
    out.v[lane] = *at;
    if (lane + 1 < count) at += from.state;
  }
  return out;
}
template <int N>
DYNWITNESS_INLINE void scatter(const States<N>& from, const Strided<double>& to, std::size_t first,
                               int count, int number) {
  double* at = to.at + static_cast<std::ptrdiff_t>(first) * to.state + number * to.number;
  for (int lane = 0;; at += to.state) {
    *at = from.v[lane];
    if (++lane == count) return;
  }
}

/// Numbers 0 to numbers - 1 of these states, each handed to put(number, States). Where they lie
/// side by side N states' N numbers are read as they lie, and turned about in registers.
template <int N, typename Put>
DYNWITNESS_INLINE void gatherAll(const Strided<const double>& from, std::size_t first, int count,
                                 int numbers, const Put& put) {
  int k = 0;
  if (count == N && from.number == 1) {
    const double* const at = from.at + static_cast<std::ptrdiff_t>(first) * from.state;
    for (; k + N <= numbers; k += N) {
      typename States<N>::Vector rows[N];
      for (int lane = 0; lane < N; ++lane)
        rows[lane] =
            *reinterpret_cast<const typename Unaligned<N>::Vector*>(at + lane * from.state + k);
      transpose(rows);
      for (int i = 0; i < N; ++i) put(k + i, States<N>(rows[i]));
    }
  }
  for (; k < numbers; ++k) put(k, gather<N>(from, first, count, k));
}
template <int N>
DYNWITNESS_INLINE void numbersOf(const Strided<const double>& from, std::size_t first, int count,
                                 int numbers, States<N>* to) {
  gatherAll<N>(from, first, count, numbers,
               [&](int k, const States<N>& x) DYNWITNESS_INLINE_LAMBDA { to[k] = x; });
}
/// Positions with their sines and cosines.
template <int N>
DYNWITNESS_INLINE void positionsOf(const Strided<const double>& from, std::size_t first, int count,
                                   int positions, JointPosition<States<N>>* to) {
  gatherAll<N>(from, first, count, positions,
               [&](int k, const States<N>& x) DYNWITNESS_INLINE_LAMBDA {
                 to[k].q = x;
                 sineCosine(x, to[k].s, to[k].c);
               });
}
/// The way back, to numbers `begin` and after.
template <int N>
DYNWITNESS_INLINE void scatterAll(const States<N>* from, int numbers, const Strided<double>& to,
                                  std::size_t first, int count, int begin = 0) {
  int k = 0;
  if (count == N && to.number == 1) {
    double* const at = to.at + static_cast<std::ptrdiff_t>(first) * to.state + begin;
    for (; k + N <= numbers; k += N) {
      typename States<N>::Vector rows[N];
      for (int i = 0; i < N; ++i) rows[i] = from[k + i].v;
      transpose(rows);
      for (int lane = 0; lane < N; ++lane)
        *reinterpret_cast<typename Unaligned<N>::Vector*>(at + lane * to.state + k) = rows[lane];
    }
  }
  for (; k < numbers; ++k) scatter<N>(from[k], to, first, count, begin + k);
}

}  // namespace detail

/// How many doubles the widest vectors of this processor hold.
inline int widestVectors() {
  return kHasAvx512 ? 8 : kHasAvx2 ? 4 : 2;
}

namespace detail {

/// A workspace for one of the widths that this processor has.
template <template <int> class Workspace>
class OfWidth {
 public:
  /// @param who  of the message
  /// @throws std::invalid_argument  the processor has no such vectors
  OfWidth(const Plan<double>& plan, int width, const char* who)
      : workspace_(made(plan, width, who)) {}

  int width() const {
    return std::visit([](const auto& ws) { return ws.kWidth; }, workspace_);
  }
  template <typename F>
  void visit(const F& f) {
    std::visit(f, workspace_);
  }

 private:
#ifdef __x86_64__
  using Any = std::variant<Workspace<2>, Workspace<4>, Workspace<8>>;
#else
  using Any = std::variant<Workspace<2>>;
#endif
  static Any made(const Plan<double>& plan, int width, const char* who) {
    if (width == 2) return Any(std::in_place_index<0>, plan);
#ifdef __x86_64__
    if (width == 4 && kHasAvx2) return Any(std::in_place_index<1>, plan);
    if (width == 8 && kHasAvx512) return Any(std::in_place_index<2>, plan);
#endif
    throw std::invalid_argument(
        std::string(who) + ": width " + std::to_string(width) +
        " was asked; allowed: 2, 4 with AVX2, 8 with AVX-512 (here at most " +
        std::to_string(widestVectors()) + ")");
  }

  Any workspace_;
};

}  // namespace detail

}  // namespace dynwitness::recursive::fast
