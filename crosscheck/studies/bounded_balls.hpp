// SPDX-License-Identifier: GPL-3.0-or-later
// Matrices of balls in double.
#pragma once

#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/bounded.hpp"

namespace dynwitness::crosscheck {

/// The doubles nearest to the midpoints, and how far the numbers in the balls may be from them.
template <typename Derived>
Bounded boundedBalls(const Eigen::MatrixBase<Derived>& m) {
  Bounded out{Eigen::MatrixXd(m.rows(), m.cols()), Eigen::MatrixXd(m.rows(), m.cols())};
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      out.value(i, j) = m(i, j).mid();
      out.bound(i, j) = (m(i, j) - Ball(out.value(i, j))).atMost();
    }
  return out;
}

}  // namespace dynwitness::crosscheck
