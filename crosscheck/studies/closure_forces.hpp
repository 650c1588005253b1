// SPDX-License-Identifier: GPL-3.0-or-later
// What forces of closures do to accelerations.
#pragma once

#include "recursive/constraints.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::crosscheck {

/** M^-1 J', n x m: column k is what a unit force of closure equation k adds to qdd.
    @param LDL  M, by recursive::factorize()
    @param J    of m closure equations, m x n */
template <typename T>
recursive::MatrixX<T> byClosureForces(const recursive::MatrixX<T>& LDL,
                                      const recursive::MatrixX<T>& J) {
  recursive::MatrixX<T> out = J.transpose();
  for (Eigen::Index k = 0; k < out.cols(); ++k) {
    recursive::VectorX<T> column = out.col(k);
    recursive::solve(LDL, column);
    out.col(k) = column;
  }
  return out;
}

}  // namespace dynwitness::crosscheck
