// SPDX-License-Identifier: GPL-3.0-or-later
// Which rates of a closed mechanism are independent, and which depend on them.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include <Eigen/QR>

#include "recursive/constraints.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::crosscheck {

using Indices = std::vector<int>;

/// The columns that rows depend on most, as many as rows.
inline Indices pivots(const Eigen::MatrixXd& J, const Indices& columns) {
  Indices out;
  if (J.rows() == 0) return out;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J);
  for (Eigen::Index k = 0; k < J.rows(); ++k)
    out.push_back(columns[static_cast<std::size_t>(qr.colsPermutation().indices()(k))]);
  std::sort(out.begin(), out.end());
  return out;
}
/// Both are in order.
inline Indices without(const Indices& all, const Indices& some) {
  Indices out;
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(out));
  return out;
}

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
