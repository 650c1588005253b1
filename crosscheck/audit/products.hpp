// SPDX-License-Identifier: GPL-3.0-or-later
// Products of matrices over the field and over duals of it, at once: each entry a sum of products.
// Eigen's are expressions, written for caches and vectors of doubles, and each pair of types costs
// every file that multiplies them 0.1 to 1.2 s and 15 to 80 MB of compiling.
#pragma once

#include <type_traits>

#include <Eigen/Core>

#include "crosscheck/scalars/dual.hpp"
#include "crosscheck/scalars/prime_field.hpp"

namespace dynwitness::audit {
namespace detail {

template <typename T>
inline constexpr bool kIsExact = std::is_same_v<T, crosscheck::PrimeField>;
template <typename T>
inline constexpr bool kIsExact<crosscheck::Dual<T>> = kIsExact<T>;

/// A matrix over such a scalar, or the transpose of one.
template <typename M>
inline constexpr bool kIsFactor = false;
template <typename T, int R, int C, int O, int MaxR, int MaxC>
inline constexpr bool kIsFactor<Eigen::Matrix<T, R, C, O, MaxR, MaxC>> = kIsExact<T>;
template <typename M>
inline constexpr bool kIsFactor<Eigen::Transpose<M>> = kIsFactor<std::remove_const_t<M>>;

}  // namespace detail

/// (A row times a column stays Eigen's, which is a number to it.)
template <typename A, typename B,
          typename = std::enable_if_t<detail::kIsFactor<A> && detail::kIsFactor<B> &&
                                      !(A::RowsAtCompileTime == 1 && B::ColsAtCompileTime == 1)>>
Eigen::Matrix<typename A::Scalar, A::RowsAtCompileTime, B::ColsAtCompileTime> operator*(
    const A& a, const B& b) {
  using T = typename A::Scalar;
  eigen_assert(a.cols() == b.rows());
  Eigen::Matrix<T, A::RowsAtCompileTime, B::ColsAtCompileTime> out;
  out.resize(a.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j)
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      T sum = T(0);
      for (Eigen::Index k = 0; k < a.cols(); ++k) sum += a(i, k) * b(k, j);
      out(i, j) = sum;
    }
  return out;
}

}  // namespace dynwitness::audit
