// SPDX-License-Identifier: Apache-2.0
// First derivatives of forward dynamics from those of inverse dynamics, over a plan.
#pragma once

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
  std::vector<int> inboard;  ///< the next rate inboard of each, -1: none
  std::vector<int> run;      ///< the first of the rates that follow each other up to this one
  std::vector<int> outboard, first;  ///< all rates outboard of rate i, from place first[i] on
  std::size_t width;                 ///< of a matrix in a row, a multiple of kBlock
  std::vector<T> rows;  ///< d tau/dq, d tau/dqd and 1 beside each other, replaced by the solutions
  std::vector<T> M;     ///< replaced by L and, on the diagonal, 1/D
};

template <typename T>
AccelerationDerivativesWorkspace<T>::AccelerationDerivativesWorkspace(const Plan<T>& plan)
    : of_tau(plan),
      inboard(plan.dof, -1),
      run(plan.dof),
      first(plan.dof + 1, 0),
      width((plan.dof + kBlock - 1) / kBlock * kBlock),
      rows(plan.dof * 3 * width, T(0)),
      M(plan.dof * width, T(0)) {
  for (const Link<T>& link : plan.links) {
    int p = link.parent;
    while (p > 0 && plan.links[p - 1].axes == 0) p = plan.links[p - 1].parent;
    const int last = p == 0 ? -1 : plan.links[p - 1].dof + plan.links[p - 1].axes - 1;
    for (int k = 0; k < link.axes; ++k) inboard[link.dof + k] = k == 0 ? last : link.dof + k - 1;
  }
  for (int i = 0; i < plan.dof; ++i) {
    run[i] = i > 0 && inboard[i] == i - 1 ? run[i - 1] : i;
    for (int j = inboard[i]; j >= 0; j = inboard[j]) ++first[j + 1];
  }
  for (int i = 0; i < plan.dof; ++i) first[i + 1] += first[i];
  outboard.resize(first[plan.dof]);
  std::vector<int> place(first.begin(), first.end() - 1);
  for (int i = 0; i < plan.dof; ++i)
    for (int j = inboard[i]; j >= 0; j = inboard[j]) outboard[place[j]++] = i;
}

namespace detail {

/// M = L' D L, the tips first, so that L has no entry where M has none: L and 1/D in place.
template <typename T>
DYNWITNESS_INLINE void factorizeOutermostFirst(AccelerationDerivativesWorkspace<T>& ws) {
  const std::size_t width = ws.width;
  for (int k = static_cast<int>(ws.inboard.size()) - 1; k >= 0; --k) {
    T* const row = ws.M.data() + k * width;
    row[k] = T(1) / row[k];
    for (int i = ws.inboard[k]; i >= 0; i = ws.inboard[i]) {
      const T share = row[i] * row[k];
      T* const of_i = ws.M.data() + i * width;
      for (int end = i; end >= 0; end = ws.inboard[ws.run[end]])
        for (int j = ws.run[end]; j <= end; ++j) of_i[j] = of_i[j] - share * row[j];
    }
    for (int end = ws.inboard[k]; end >= 0; end = ws.inboard[ws.run[end]])
      for (int j = ws.run[end]; j <= end; ++j) row[j] = row[j] * row[k];
  }
}

/// Solves L' D L X = B for kPacks packs of columns, from `column` on; -X where negative.
template <int kPacks, typename Pack, typename T>
DYNWITNESS_INLINE void solveColumns(AccelerationDerivativesWorkspace<T>& ws, std::size_t column,
                                    std::size_t negative) {
  const std::size_t stride = 3 * ws.width, width = ws.width;
  T* const B = ws.rows.data() + column;
  const T* const L = ws.M.data();
  const int n = static_cast<int>(ws.inboard.size());
  Pack sums[kPacks];
  const auto subtract = [&](const T& factor, const T* row) DYNWITNESS_INLINE_LAMBDA {
    for (int k = 0; k < kPacks; ++k) sums[k] = sums[k] - factor * Pack::load(row + k * kBlock);
  };
  for (int i = n - 1; i >= 0; --i) {
    T* const row = B + i * stride;
    for (int k = 0; k < kPacks; ++k) sums[k] = Pack::load(row + k * kBlock);
    for (int at = ws.first[i]; at < ws.first[i + 1]; ++at)
      subtract(L[ws.outboard[at] * width + i], B + ws.outboard[at] * stride);
    for (int k = 0; k < kPacks; ++k) sums[k].store(row + k * kBlock);
  }
  for (int i = 0; i < n; ++i) {
    T* const row = B + i * stride;
    const T inverse_D = L[i * width + i], minus = -inverse_D;
    for (int k = 0; k < kPacks; ++k)
      sums[k] = (column + k * kBlock < negative ? minus : inverse_D) * Pack::load(row + k * kBlock);
    for (int j = ws.inboard[i]; j >= 0; j = ws.inboard[j])
      subtract(L[i * width + j], B + j * stride);
    for (int k = 0; k < kPacks; ++k) sums[k].store(row + k * kBlock);
  }
}

template <typename Pack, typename T>
DYNWITNESS_INLINE void accelerationDerivativesBody(const Plan<T>& plan, const JointPosition<T>* x,
                                                   const T* qd, const T* qdd,
                                                   AccelerationDerivativesWorkspace<T>& ws,
                                                   const AccelerationDerivatives<T>& out) {
  const std::size_t n = plan.dof, width = ws.width, stride = 3 * width;
  T* const rows = ws.rows.data();
  inverseDynamicsDerivativesBody<Pack>(plan, x, qd, qdd, ws.of_tau,
                                       {rows, rows + width, stride, ws.M.data(), width});
  for (std::size_t i = 0; i < n; ++i) {
    std::fill_n(rows + i * stride + 2 * width, n, T(0));
    rows[i * stride + 2 * width + i] = T(1);
  }
  factorizeOutermostFirst(ws);
  constexpr int kPacks = 6;  // what registers hold beside a factor
  std::size_t column = 0;
  for (; column + kPacks * kBlock <= stride; column += kPacks * kBlock)
    solveColumns<kPacks, Pack>(ws, column, 2 * width);
  for (; column < stride; column += 3 * kBlock) solveColumns<3, Pack>(ws, column, 2 * width);
  for (std::size_t i = 0; i < n; ++i) {
    const T* const row = rows + i * stride;
    std::copy_n(row, n, out.dqdd_dq + i * n);
    std::copy_n(row + width, n, out.dqdd_dqd + i * n);
    std::copy_n(row + 2 * width, n, out.dqdd_dtau + i * n);
  }
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
