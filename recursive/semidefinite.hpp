// SPDX-License-Identifier: Apache-2.0
// Solving with a symmetric matrix that has no negative eigenvalue, and may have no inverse.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "recursive/composite_body.hpp"

namespace dynwitness::recursive {

namespace detail {

template <typename T, typename = void>
struct HasEquality : std::false_type {};
template <typename T>
struct HasEquality<T, std::void_t<decltype(std::declval<T>() == std::declval<T>())>>
    : std::true_type {};

/// Whether arithmetic on T rounds, so that what ought to be zero is not. A scalar that carries a
/// double says so by specialising it: its pivots are then those of the double.
template <typename T>
struct Rounds : std::is_floating_point<T> {};

/// cbrt(eps) of what T computes in.
template <typename T>
T cubeRootOfEpsilon() {
  using std::cbrt;
  if constexpr (std::is_floating_point_v<T>)
    return cbrt(std::numeric_limits<T>::epsilon());
  else
    return T(cbrt(std::numeric_limits<double>::epsilon()));
}

}  // namespace detail

/** N = P' L D L' P by eliminating diagonal pivots until none is left that is not zero; N has that
    many independent rows, and what remains of a positive semidefinite matrix without a pivot is
    zero.

    Exact scalars: a pivot is zero or it is not. Floating-point numbers: the largest is taken, and
    counts as zero below cbrt(eps)^2 times the first (N is made of squares of lengths, for which
    ConstrainedSolver has the same limit, cbrt(eps)). Scalars that cannot be compared: every pivot
    counts. */
template <typename T>
class SemidefiniteSolver {
 public:
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  explicit SemidefiniteSolver(int size)
      : A_(MatrixX<T>::Constant(size, size, T(0))),
        order_(size),
        determined_(size, 1),
        work_(Vector::Constant(size, T(0))) {}

  void factorize(const MatrixX<T>& N) {
    A_ = N;
    const Eigen::Index n = size();
    for (Eigen::Index i = 0; i < n; ++i) order_[i] = static_cast<int>(i);
    rank_ = 0;
    while (rank_ < n && pivot(rank_)) {
      const Eigen::Index r = rank_;
      for (Eigen::Index i = r + 1; i < n; ++i) {
        const T l = A_(i, r) / A_(r, r);
        for (Eigen::Index j = r + 1; j <= i; ++j) A_(i, j) -= l * A_(r, j);
        for (Eigen::Index j = r + 1; j < i; ++j) A_(j, i) = A_(i, j);
        A_(i, r) = l;  // below the diagonal L, above it D L'
      }
      ++rank_;
    }
    findDetermined();
  }

  Eigen::Index size() const { return A_.rows(); }
  int rank() const { return rank_; }
  /// By entry of x: whether N x = b says what it is.
  const std::vector<char>& determined() const { return determined_; }

  /// One solution of N x = b, in place; entries of dependent rows are zero.
  /// @return  row by row what b contradicts N by: zero where the row is independent
  template <typename X>
  const Vector& solve(X& b) {
    const Eigen::Index n = size(), r = rank_;
    for (Eigen::Index i = 0; i < n; ++i) work_(i) = b[order_[i]];
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index k = 0; k < std::min<Eigen::Index>(i, r); ++k)
        work_(i) -= A_(i, k) * work_(k);
    for (Eigen::Index i = 0; i < r; ++i) work_(i) /= A_(i, i);
    for (Eigen::Index i = r - 1; i >= 0; --i)
      for (Eigen::Index k = i + 1; k < r; ++k) work_(i) -= A_(k, i) * work_(k);
    for (Eigen::Index i = 0; i < n; ++i) b[order_[i]] = i < r ? work_(i) : T(0);
    for (Eigen::Index i = 0; i < r; ++i) work_(i) = T(0);
    return work_;
  }

 private:
  static bool isZero(const T& pivot, const T& first) {
    if constexpr (detail::Rounds<T>::value) {
      const T least = detail::cubeRootOfEpsilon<T>();
      return !(pivot > least * least * first);
    } else if constexpr (detail::HasEquality<T>::value) {
      return pivot == T(0);
    } else {
      return false;
    }
  }
  /// Brings the next pivot to the diagonal's place r; false when there is none.
  bool pivot(Eigen::Index r) {
    Eigen::Index best = r;
    if constexpr (detail::Rounds<T>::value) {
      for (Eigen::Index i = r + 1; i < size(); ++i)
        if (A_(i, i) > A_(best, best)) best = i;
    } else {
      while (best < size() && isZero(A_(best, best), T(0))) ++best;
      if (best == size()) return false;
    }
    if (r == 0) first_ = A_(best, best);
    if (isZero(A_(best, best), first_)) return false;
    if (best != r) {
      for (Eigen::Index k = 0; k < size(); ++k) std::swap(A_(r, k), A_(best, k));
      for (Eigen::Index k = 0; k < size(); ++k) std::swap(A_(k, r), A_(k, best));
      std::swap(order_[r], order_[best]);
    }
    return true;
  }
  /// N x = 0 is solved by (-L_11'^-1 L_21'; 1): what moves there is not determined.
  void findDetermined() {
    const Eigen::Index n = size(), r = rank_;
    for (char& d : determined_) d = 1;
    for (Eigen::Index j = r; j < n; ++j) {
      determined_[order_[j]] = 0;
      for (Eigen::Index i = r - 1; i >= 0; --i) {
        work_(i) = A_(j, i);
        for (Eigen::Index k = i + 1; k < r; ++k) work_(i) -= A_(k, i) * work_(k);
        bool moves = true;
        if constexpr (detail::Rounds<T>::value) {
          using std::abs;
          moves = abs(work_(i)) > detail::cubeRootOfEpsilon<T>();
        } else if constexpr (detail::HasEquality<T>::value) {
          moves = !(work_(i) == T(0));
        }
        if (moves) determined_[order_[i]] = 0;
      }
    }
  }

  MatrixX<T> A_;
  std::vector<int> order_;
  std::vector<char> determined_;
  Vector work_;
  T first_ = T(0);
  int rank_ = 0;
};

}  // namespace dynwitness::recursive
