// SPDX-License-Identifier: Apache-2.0
// Solving with the mass matrix of a tree, whose zeros stay zeros.
#pragma once

#include <vector>

#include "recursive/composite_body.hpp"

namespace dynwitness::recursive {

/// Matrices whose rows are contiguous: what is solved for is taken row by row.
template <typename T>
using RowsX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/** For each rate the next one inboard, -1 where there is none: the rate before it of its joint,
    else the last one of the nearest link inboard that moves. M(i, j) is zero unless one of i and j
    is reached from the other that way.
    @throws std::invalid_argument  joints share a rate: its row knows several branches */
template <typename T>
std::vector<int> inboardRates(const Model<T>& model) {
  requireOwnRates(model, "inboardRates");
  std::vector<int> inboard(model.dof(), -1);
  for (const LinkModel<T>& link : model.links) {
    int p = link.parent;
    while (p >= 0 && model.links[p].dof < 0) p = model.links[p].parent;
    const int last = p < 0 ? -1 : model.links[p].dof + axisCount(model.links[p].kind) - 1;
    for (int k = 0; k < axisCount(link.kind); ++k)
      inboard[link.dof + k] = k == 0 ? last : link.dof + k - 1;
  }
  return inboard;
}

/** M = L' D L of a tree's mass matrix, the tips eliminated first, so that L (unit lower triangle)
    has no entry where M has none: sum of depth^2 products instead of n^3 / 6. L and D replace M's
    lower half and diagonal; the upper half is left alone.
    @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), table 6.3, p. 112 */
template <typename T>
void factorizeTree(const std::vector<int>& inboard, MatrixX<T>& M) {
  for (int k = static_cast<int>(inboard.size()) - 1; k >= 0; --k) {
    for (int i = inboard[k]; i >= 0; i = inboard[i]) {
      const T share = M(k, i) / M(k, k);
      for (int j = i; j >= 0; j = inboard[j]) M(i, j) -= share * M(k, j);
      M(k, i) = share;
    }
  }
}

/// Solves L' D L X = B for all columns of B at once, in place; L and D from factorizeTree().
template <typename T>
void solveTree(const std::vector<int>& inboard, const MatrixX<T>& LDL, RowsX<T>& B) {
  const int n = static_cast<int>(inboard.size());
  for (int i = n - 1; i >= 0; --i)
    for (int j = inboard[i]; j >= 0; j = inboard[j]) B.row(j) -= B.row(i) * LDL(i, j);
  for (int i = 0; i < n; ++i) {
    B.row(i) /= LDL(i, i);
    for (int j = inboard[i]; j >= 0; j = inboard[j]) B.row(i) -= B.row(j) * LDL(i, j);
  }
}

}  // namespace dynwitness::recursive
