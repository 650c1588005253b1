// SPDX-License-Identifier: GPL-3.0-or-later
// Which rates of a closed mechanism are independent, and which depend on them.
#pragma once

#include <vector>

#include "recursive/constraints.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::crosscheck {

using Indices = std::vector<int>;

/// The columns that rows depend on most, as many as rows.
Indices pivots(const Eigen::MatrixXd& J, const Indices& columns);
/// Both are in order.
Indices without(const Indices& all, const Indices& some);
/// X of the least |A X - B|, column by column, by Householder's reflections with pivots.
Eigen::MatrixXd solvedByColumns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

/// X of  D X = R,  D square and regular: of D' D, which needs no pivots.
template <typename T>
recursive::MatrixX<T> solved(const recursive::MatrixX<T>& D, const recursive::MatrixX<T>& R) {
  recursive::MatrixX<T> normal = D.transpose() * D, X = D.transpose() * R;
  recursive::factorize(normal);
  for (Eigen::Index k = 0; k < X.cols(); ++k) {
    recursive::VectorX<T> column = X.col(k);
    recursive::solve(normal, column);
    X.col(k) = column;
  }
  return X;
}

}  // namespace dynwitness::crosscheck
