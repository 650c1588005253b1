// SPDX-License-Identifier: Apache-2.0
// Solving with a mass matrix.
#pragma once

#include "recursive/composite_body.hpp"

namespace dynwitness::recursive {

/** M = L D L' of a symmetric matrix, without square roots or pivoting, so that it runs on any
    field. L (unit lower triangle, below the diagonal) and D (on it) replace M. M is positive
    definite exactly when all D are positive. */
template <typename T>
void factorize(MatrixX<T>& M) {
  const Eigen::Index n = M.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) M(j, j) -= M(j, k) * M(j, k) * M(k, k);
    for (Eigen::Index i = j + 1; i < n; ++i) {
      for (Eigen::Index k = 0; k < j; ++k) M(i, j) -= M(i, k) * M(k, k) * M(j, k);
      M(i, j) /= M(j, j);
    }
  }
}

/// Solves L D L' x = b in place, L and D from factorize(). b: any vector with operator[].
template <typename T, typename Vector>
void solve(const MatrixX<T>& LDL, Vector& b) {
  const Eigen::Index n = LDL.rows();
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < i; ++k) b[i] -= LDL(i, k) * b[k];
  for (Eigen::Index i = 0; i < n; ++i) b[i] /= LDL(i, i);
  for (Eigen::Index i = n - 1; i >= 0; --i)
    for (Eigen::Index k = i + 1; k < n; ++k) b[i] -= LDL(k, i) * b[k];
}

}  // namespace dynwitness::recursive
