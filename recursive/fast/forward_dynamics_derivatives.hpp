// SPDX-License-Identifier: Apache-2.0
// First derivatives of forward dynamics from those of inverse dynamics, over a plan.
#pragma once

#include <algorithm>
#include <utility>
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
  template <typename P>
  explicit AccelerationDerivativesWorkspace(const Plan<P>& plan);

  DerivativesWorkspace<T> of_tau;
  /// Rates that feel each other, in the order in which they are done: of rate i those outboard of
  /// it from place first_outboard[i] on, those inboard from first_inboard[i] on.
  std::vector<int> outboard, first_outboard, inboard, first_inboard;
  std::size_t width;       ///< of a matrix in a row, a multiple of kBlock
  std::vector<T> rows;     ///< d tau/dq and d tau/dqd beside each other, replaced by the solutions
  std::vector<T> M;        ///< replaced by L and, on the diagonal, 1/D
  std::vector<T> inverse;  ///< of M
};

template <typename T>
template <typename P>
AccelerationDerivativesWorkspace<T>::AccelerationDerivativesWorkspace(const Plan<P>& plan)
    : of_tau(plan),
      width((plan.dof + kBlock - 1) / kBlock * kBlock),
      rows(plan.dof * 2 * width, T(0)),
      M(plan.dof * width, T(0)),
      inverse(plan.dof * width, T(0)) {
  const std::vector<std::vector<int>> in = ratesInboard(plan);
  std::vector<std::vector<int>> out(plan.dof);
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

/// As many packs as stay in registers: constant places, so that compilers see that.
template <typename Pack, typename T, std::size_t... k>
struct PacksOfRow {
  Pack sums[sizeof...(k)];

  DYNWITNESS_INLINE void load(const T* row) { ((sums[k] = Pack::load(row + k * kBlock)), ...); }
  DYNWITNESS_INLINE void loadTimes(const T& factor, const T* row) {
    ((sums[k] = factor * Pack::load(row + k * kBlock)), ...);
  }
  DYNWITNESS_INLINE void subtract(const T& factor, const T* row) {
    ((sums[k] = sums[k] - factor * Pack::load(row + k * kBlock)), ...);
  }
  DYNWITNESS_INLINE void store(T* row) const { (sums[k].store(row + k * kBlock), ...); }
};

/// Solves L' D L X = -B for so many packs of columns, from `column` on.
template <typename Pack, typename T, std::size_t... k>
DYNWITNESS_INLINE void solveColumns(AccelerationDerivativesWorkspace<T>& ws, std::size_t column,
                                    std::index_sequence<k...>) {
  const std::size_t stride = 2 * ws.width, width = ws.width;
  T* const B = ws.rows.data() + column;
  const T* const L = ws.M.data();
  const int *const outboard = ws.outboard.data(), *const inboard = ws.inboard.data();
  const int n = static_cast<int>(ws.first_inboard.size()) - 1;
  for (int i = n - 1; i >= 0; --i) {
    PacksOfRow<Pack, T, k...> row;
    row.load(B + i * stride);
    for (int at = ws.first_outboard[i], end = ws.first_outboard[i + 1]; at < end; ++at)
      row.subtract(L[outboard[at] * width + i], B + outboard[at] * stride);
    row.store(B + i * stride);
  }
  for (int i = 0; i < n; ++i) {
    PacksOfRow<Pack, T, k...> row;
    row.loadTimes(-L[i * width + i], B + i * stride);
    for (int at = ws.first_inboard[i], end = ws.first_inboard[i + 1]; at < end; ++at)
      row.subtract(L[i * width + inboard[at]], B + inboard[at] * stride);
    row.store(B + i * stride);
  }
}

/** X = 1/M from L and D. L X = D^-1 L^-T is zero below the diagonal and 1/D on it, so that, root
    first and with the symmetry of X,
        X_ic = -sum_p L_ip X_pc  (c < i),   X_ii = 1/D_i - sum_p L_ip X_ip,   p inboard of i:
    rows up to i - 1 and, mirrored, columns up to i - 1 of X are known then. */
template <typename Pack, typename T>
DYNWITNESS_INLINE void invert(AccelerationDerivativesWorkspace<T>& ws) {
  const std::size_t width = ws.width;
  const int n = static_cast<int>(ws.first_inboard.size()) - 1;
  const T zeros[kBlock] = {T(0), T(0), T(0), T(0)};
  for (int i = 0; i < n; ++i) {
    T* const row = ws.inverse.data() + i * width;
    const T* const L = ws.M.data() + i * width;
    const int *const first = ws.inboard.data() + ws.first_inboard[i], *const last =
                                                                          ws.inboard.data() +
                                                                          ws.first_inboard[i + 1];
    for (int column = 0; column < i; column += kBlock) {  // what is beyond i - 1 comes later
      Pack sum = Pack::load(zeros);
      for (const int* p = first; p != last; ++p)
        sum = sum - L[*p] * Pack::load(ws.inverse.data() + *p * width + column);
      sum.store(row + column);
    }
    T own = L[i];
    for (const int* p = first; p != last; ++p) own = own - L[*p] * row[*p];
    row[i] = own;
    for (int c = 0; c < i; ++c) ws.inverse[c * width + i] = row[c];
  }
}

/// Solves for packs of columns as long as so many are left.
template <std::size_t packs, typename Pack, typename T>
DYNWITNESS_INLINE void solvePacks(AccelerationDerivativesWorkspace<T>& ws, std::size_t& column) {
  for (; column + packs * kBlock <= 2 * ws.width; column += packs * kBlock)
    solveColumns<Pack>(ws, column, std::make_index_sequence<packs>());
}

/// Into ws.rows and ws.inverse.
template <typename Pack, typename Column = Pack, typename T, typename P>
DYNWITNESS_INLINE void solveAccelerationDerivatives(const Plan<P>& plan, const JointPosition<T>* x,
                                                    const T* qd, const T* qdd,
                                                    AccelerationDerivativesWorkspace<T>& ws) {
  T* const rows = ws.rows.data();
  if (!plan.is_chain) {
    std::fill(ws.rows.begin(), ws.rows.end(), T(0));
    std::fill(ws.M.begin(), ws.M.end(), T(0));
  }
  inverseDynamicsDerivativesBody<Pack, Column>(
      plan, x, qd, qdd, ws.of_tau, {rows, rows + ws.width, 2 * ws.width, ws.M.data(), ws.width});
  factorizeOutermostFirst<Pack>(ws);
  std::size_t column = 0;  // as many at a time as registers hold beside a factor
  if constexpr (std::is_same_v<T, P>) {
    solvePacks<12, Pack>(ws, column);
    solvePacks<8, Pack>(ws, column);
  }
  solvePacks<4, Pack>(ws, column);  // which 16 registers of many states are
  solvePacks<2, Pack>(ws, column);
  invert<Pack>(ws);
}

template <typename Pack, typename T>
DYNWITNESS_INLINE void accelerationDerivativesBody(const Plan<T>& plan, const JointPosition<T>* x,
                                                   const T* qd, const T* qdd,
                                                   AccelerationDerivativesWorkspace<T>& ws,
                                                   const AccelerationDerivatives<T>& out) {
  solveAccelerationDerivatives<Pack>(plan, x, qd, qdd, ws);
  const std::size_t n = plan.dof, width = ws.width;
  const T* const rows = ws.rows.data();
  for (std::size_t i = 0; i < n; ++i) {
    std::copy_n(rows + 2 * i * width, n, out.dqdd_dq + i * n);
    std::copy_n(rows + (2 * i + 1) * width, n, out.dqdd_dqd + i * n);
    std::copy_n(ws.inverse.data() + i * width, n, out.dqdd_dtau + i * n);
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

    by M = L' D L with the tree's own zeros, a dozen packs of columns in one pass in and one out,
    O(n^2 depth).
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
