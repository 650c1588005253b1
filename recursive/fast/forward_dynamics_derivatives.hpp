// SPDX-License-Identifier: Apache-2.0
// First derivatives of forward dynamics from those of inverse dynamics, over a plan.
#pragma once

#include <algorithm>
#include <vector>

#include "recursive/fast/inverse_dynamics_derivatives.hpp"

namespace dynwitness::recursive::fast {

/// Where derivatives of qdd go: n n numbers each, row i of qdd_i.
template <typename T>
struct AccelerationDerivatives {
  T *dqdd_dq, *dqdd_dqd, *dqdd_dtau;
};

/// What is solved, and which rates feel each other; sized once for a plan.
template <typename T>
struct AccelerationDerivativesWorkspace {
  explicit AccelerationDerivativesWorkspace(const Plan<T>& plan);

  DerivativesWorkspace<T> of_tau;
  /// Rates that feel each other, in the order in which they are done: of rate i those outboard of it
  /// from place first_outboard[i] on, those inboard from first_inboard[i] on.
  std::vector<int> outboard, first_outboard, inboard, first_inboard;
  std::size_t width;    ///< of a matrix in a row, a multiple of kBlock
  std::vector<T> rows;  ///< d tau/dq, d tau/dqd and 1 beside each other, replaced by the solutions
  std::vector<T> M;     ///< replaced by L and, on the diagonal, 1/D
};

template <typename T>
AccelerationDerivativesWorkspace<T>::AccelerationDerivativesWorkspace(const Plan<T>& plan)
    : of_tau(plan),
      width((plan.dof + kBlock - 1) / kBlock * kBlock),
      rows(plan.dof * 3 * width, T(0)),
      M(plan.dof * width, T(0)) {
  std::vector<std::vector<int>> in(plan.dof), out(plan.dof);
  for (const Link<T>& link : plan.links) {
    int p = link.parent;
    while (p > 0 && plan.links[p - 1].axes == 0) p = plan.links[p - 1].parent;
    const int last = p == 0 ? -1 : plan.links[p - 1].dof + plan.links[p - 1].axes - 1;
    for (int k = 0, d = link.dof; k < link.axes; ++k, ++d) {
      const int next = k == 0 ? last : d - 1;
      if (next < 0) continue;
      in[d] = in[next];
      in[d].push_back(next);
    }
  }
  for (int i = plan.dof - 1; i >= 0; --i)
    for (const int j : in[i]) out[j].push_back(i);
  for (int i = 0; i < plan.dof; ++i) {
    first_outboard.push_back(static_cast<int>(outboard.size()));
    outboard.insert(outboard.end(), out[i].begin(), out[i].end());
    first_inboard.push_back(static_cast<int>(inboard.size()));
    inboard.insert(inboard.end(), in[i].begin(), in[i].end());
  }
  first_outboard.push_back(static_cast<int>(outboard.size()));
  first_inboard.push_back(static_cast<int>(inboard.size()));
}

namespace detail {

/// M = L' D L, the tips first, so that L has no entry where M has none: L and 1/D in place of the
/// lower half and the diagonal. Rows are subtracted whole, since zeros change nothing; what that
/// leaves of the upper half is not read.
template <typename Pack, typename T>
DYNWITNESS_INLINE void factorizeOutermostFirst(AccelerationDerivativesWorkspace<T>& ws) {
  const std::size_t width = ws.width;
  for (int k = static_cast<int>(ws.first_inboard.size()) - 2; k >= 0; --k) {
    T* const row = ws.M.data() + k * width;
    const T inverse_D = T(1) / row[k];
    for (int at = ws.first_inboard[k + 1] - 1; at >= ws.first_inboard[k]; --at) {
      const int i = ws.inboard[at];
      const T share = row[i] * inverse_D;
      T* const of_i = ws.M.data() + i * width;
      for (int j = 0; j <= i; j += kBlock)
        (Pack::load(of_i + j) - share * Pack::load(row + j)).store(of_i + j);
    }
    for (int j = 0; j < k; j += kBlock) (inverse_D * Pack::load(row + j)).store(row + j);
    row[k] = inverse_D;
  }
}

/// Solves L' D L X = B for kPacks packs of columns, from `column` on, and hands X out; -X of d tau.
template <int kPacks, typename Pack, typename T>
DYNWITNESS_INLINE void solveColumns(AccelerationDerivativesWorkspace<T>& ws, std::size_t column,
                                    const AccelerationDerivatives<T>& out) {
  const std::size_t stride = 3 * ws.width, width = ws.width;
  T* const B = ws.rows.data() + column;
  const T* const L = ws.M.data();
  const int n = static_cast<int>(ws.first_inboard.size()) - 1;
  Pack sums[kPacks];
  T* to[kPacks];
  int lanes[kPacks];  ///< that are columns of the matrix, and not there to fill the pack
  for (int k = 0; k < kPacks; ++k) {
    const std::size_t matrix = (column + k * kBlock) / width, c = (column + k * kBlock) % width;
    to[k] = (matrix == 0 ? out.dqdd_dq : matrix == 1 ? out.dqdd_dqd : out.dqdd_dtau) + c;
    lanes[k] = std::min(kBlock, n - static_cast<int>(c));
  }
  const auto subtract = [&](const T& factor, const T* row) DYNWITNESS_INLINE_LAMBDA {
    for (int k = 0; k < kPacks; ++k) sums[k] = sums[k] - factor * Pack::load(row + k * kBlock);
  };
  for (int i = n - 1; i >= 0; --i) {
    T* const row = B + i * stride;
    for (int k = 0; k < kPacks; ++k) sums[k] = Pack::load(row + k * kBlock);
    for (int at = ws.first_outboard[i]; at < ws.first_outboard[i + 1]; ++at)
      subtract(L[ws.outboard[at] * width + i], B + ws.outboard[at] * stride);
    for (int k = 0; k < kPacks; ++k) sums[k].store(row + k * kBlock);
  }
  for (int i = 0; i < n; ++i) {
    T* const row = B + i * stride;
    const T inverse_D = L[i * width + i], minus = -inverse_D;
    for (int k = 0; k < kPacks; ++k)
      sums[k] =
          (column + k * kBlock < 2 * width ? minus : inverse_D) * Pack::load(row + k * kBlock);
    for (int at = ws.first_inboard[i]; at < ws.first_inboard[i + 1]; ++at)
      subtract(L[i * width + ws.inboard[at]], B + ws.inboard[at] * stride);
    for (int k = 0; k < kPacks; ++k) {
      sums[k].store(row + k * kBlock);
      if (lanes[k] == kBlock)
        sums[k].store(to[k] + i * static_cast<std::size_t>(n));
      else
        for (int l = 0; l < lanes[k]; ++l)
          to[k][i * static_cast<std::size_t>(n) + l] = row[k * kBlock + l];
    }
  }
}

template <typename Pack, typename T>
DYNWITNESS_INLINE void accelerationDerivativesBody(const Plan<T>& plan, const JointPosition<T>* x,
                                                   const T* qd, const T* qdd,
                                                   AccelerationDerivativesWorkspace<T>& ws,
                                                   const AccelerationDerivatives<T>& out) {
  const std::size_t n = plan.dof, width = ws.width, stride = 3 * width;
  T* const rows = ws.rows.data();
  std::fill(ws.rows.begin(), ws.rows.end(), T(0));
  if (!plan.is_chain) std::fill(ws.M.begin(), ws.M.end(), T(0));
  for (std::size_t i = 0; i < n; ++i) rows[i * stride + 2 * width + i] = T(1);
  inverseDynamicsDerivativesBody<Pack>(plan, x, qd, qdd, ws.of_tau,
                                       {rows, rows + width, stride, ws.M.data(), width});
  factorizeOutermostFirst<Pack>(ws);
  std::size_t column = 0;  // as many at a time as registers hold beside a factor
  for (; column + 12 * kBlock <= stride; column += 12 * kBlock)
    solveColumns<12, Pack>(ws, column, out);
  for (; column + 6 * kBlock <= stride; column += 6 * kBlock)
    solveColumns<6, Pack>(ws, column, out);
  for (; column < stride; column += 3 * kBlock) solveColumns<3, Pack>(ws, column, out);
}

DYNWITNESS_FOR_AVX2 inline void accelerationDerivativesForAvx2(
    const Plan<double>& plan, const JointPosition<double>* x, const double* qd, const double* qdd,
    AccelerationDerivativesWorkspace<double>& ws, const AccelerationDerivatives<double>& out) {
  accelerationDerivativesBody<Quad>(plan, x, qd, qdd, ws, out);
}

}  // namespace detail

/** Derivatives of qdd at a state by q, qd and tau, n x n each: with those of tau at the same state,

        d qdd/dq = -1/M d tau/dq,   d qdd/dqd = -1/M d tau/dqd,   d qdd/dtau = 1/M

    by M = L' D L with the tree's own zeros, all 3 n columns in one pass in and one out, O(n^2
    depth).
    @param qdd  what the state's tau makes, by forwardDynamics()
    @param out  written whole, row by row
    A singular M divides by zero, as in forwardDynamics(). */
template <typename T>
void forwardDynamicsDerivatives(const Plan<T>& plan, const JointPosition<T>* x, const T* qd,
                                const T* qdd, AccelerationDerivativesWorkspace<T>& ws,
                                const AccelerationDerivatives<T>& out) {
  if constexpr (std::is_same_v<T, double>) {
    if (kHasAvx2) return detail::accelerationDerivativesForAvx2(plan, x, qd, qdd, ws, out);
    detail::accelerationDerivativesBody<TwoPairs>(plan, x, qd, qdd, ws, out);
  } else {
    detail::accelerationDerivativesBody<Lanes<T>>(plan, x, qd, qdd, ws, out);
  }
}

}  // namespace dynwitness::recursive::fast
