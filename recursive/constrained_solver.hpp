// SPDX-License-Identifier: Apache-2.0
// Accelerations and multipliers of a constrained mechanism, with redundant constraints told apart.
#pragma once

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "recursive/constraints.hpp"

namespace dynwitness::recursive {

/** Solves, for one position,

        [ M  J' ] [  qdd   ]   [ f ]
        [ J  0  ] [ -lambda ] = [ b ]                 M n x n positive definite, J m x n of any rank

    in coordinates in which M is the identity: with M = L L' and z = L' qdd,
        (1)  A = J L'^-1;  A' = Q R P'  with column pivoting, rank r
        (2)  z = (1 - Q_1 Q_1') L^-1 f  +  Q_1 R_11'^-1 (P' b)_r      Q_1, R_11: first r columns
        (3)  A' lambda = z - L^-1 f
    The first r rows of the pivoted J stand for all: qdd is right whenever the equations do not
    contradict each other, and `contradiction` says by how much they do. Where r < m, the
    multipliers that the dependent rows could share are not determined by mechanics of rigid bodies;
    `determined` says which are, and the others are one possible choice.

    A row of A counts as dependent when its part outside the rows chosen before it is shorter than
    `rank_tolerance` times the longest row. Where rows are redundant that part is rounding, eps. On
    the way through a singular pose it passes through zero: at a distance delta from the pose,
    rounding of J and gamma is worth eps / delta of qdd, and leaving the row out in a step of that
    length is worth delta^2. The default, the cube root of eps, is where the two are equal.

    At a singular pose qdd is the acceleration of least constraint (Gauss). It is also the limit
    along a motion through the pose if the multipliers stay bounded.

    Allocates; for doubles and wider. */
template <typename T>
class ConstrainedSolver {
 public:
  static T defaultRankTolerance() {
    using std::cbrt;
    return cbrt(std::numeric_limits<T>::epsilon());
  }

  /// @throws std::invalid_argument  M is not positive definite
  void factorize(const MatrixX<T>& M, const MatrixX<T>& J,
                 const T& rank_tolerance = defaultRankTolerance()) {
    llt_.compute(M);
    if (llt_.info() != Eigen::Success)
      throw std::invalid_argument("ConstrainedSolver: M: expected a positive definite matrix");
    A_transposed_ = llt_.matrixL().solve(J.transpose());  // (1)
    rank_ = 0;
    if (J.rows() == 0) return;
    qr_.compute(A_transposed_);
    using std::abs;
    const Eigen::Index most = std::min(J.rows(), J.cols());
    const T least = rank_tolerance * abs(qr_.matrixQR()(0, 0));
    while (rank_ < most && abs(qr_.matrixQR()(rank_, rank_)) > least) ++rank_;
  }

  Eigen::Index rank() const { return rank_; }
  /// Rows of J that stand for all, in their own order.
  std::vector<int> independentRows() const {
    std::vector<int> rows;
    for (Eigen::Index k = 0; k < rank_; ++k)
      rows.push_back(static_cast<int>(qr_.colsPermutation().indices()(k)));
    std::sort(rows.begin(), rows.end());
    return rows;
  }

  /// The shortest dq (in M's norm) with J dq = b.
  VectorX<T> shortest(const VectorX<T>& b) const {
    VectorX<T> z = alongConstraints(independent(b));
    llt_.matrixU().solveInPlace(z);
    return z;
  }

  struct Result {
    VectorX<T> qdd, lambda;
    std::vector<bool> determined;  ///< by multiplier
    T contradiction;               ///< largest |J qdd - b|
  };

  Result solve(const VectorX<T>& f, const VectorX<T>& b) const {
    Result result;
    const VectorX<T> free = llt_.matrixL().solve(f);
    VectorX<T> z = free + alongConstraints(independent(b) - seen(free));  // (2)
    const VectorX<T> residual = A_transposed_.transpose() * z - b;
    result.contradiction = residual.size() == 0 ? T(0) : residual.cwiseAbs().maxCoeff();
    multipliers(z - free, &result);
    llt_.matrixU().solveInPlace(z);
    result.qdd = z;
    return result;
  }

 private:
  auto R11() const {
    return qr_.matrixQR().topLeftCorner(rank_, rank_).template triangularView<Eigen::Upper>();
  }
  /// R_11'^-1 (P' b)_r
  VectorX<T> independent(const VectorX<T>& b) const {
    if (rank_ == 0) return VectorX<T>();
    const VectorX<T> pivoted = qr_.colsPermutation().transpose() * b;
    return qr_.matrixQR()
        .topLeftCorner(rank_, rank_)
        .transpose()
        .template triangularView<Eigen::Lower>()
        .solve(pivoted.head(rank_));
  }
  /// Q_1' z
  VectorX<T> seen(const VectorX<T>& z) const {
    if (rank_ == 0) return VectorX<T>();
    VectorX<T> y = z;
    y.applyOnTheLeft(qr_.householderQ().setLength(rank_).adjoint());
    return y.head(rank_);
  }
  /// Q_1 y
  VectorX<T> alongConstraints(const VectorX<T>& y) const {
    VectorX<T> z = VectorX<T>::Zero(A_transposed_.rows());
    if (rank_ == 0) return z;
    z.head(rank_) = y;
    z.applyOnTheLeft(qr_.householderQ().setLength(rank_));
    return z;
  }
  void multipliers(const VectorX<T>& reaction, Result* result) const {
    const Eigen::Index m = A_transposed_.cols();
    result->lambda = VectorX<T>::Zero(m);
    result->determined.assign(m, true);
    if (m == 0) return;
    VectorX<T> pivoted = VectorX<T>::Zero(m);
    if (rank_ > 0) pivoted.head(rank_) = R11().solve(seen(reaction));  // (3)
    result->lambda = qr_.colsPermutation() * pivoted;
    if (rank_ == m) return;
    // A' lambda = 0 is solved by (-R_11^-1 R_12; 1): what moves there is undetermined
    const auto& order = qr_.colsPermutation().indices();
    MatrixX<T> shared = qr_.matrixQR().topRightCorner(rank_, m - rank_);
    if (rank_ > 0) R11().solveInPlace(shared);
    for (Eigen::Index k = 0; k < m; ++k) {
      const bool free = k >= rank_ || shared.row(k).cwiseAbs().maxCoeff() > defaultRankTolerance();
      if (free) result->determined[order(k)] = false;
    }
  }

  Eigen::LLT<MatrixX<T>> llt_;
  Eigen::ColPivHouseholderQR<MatrixX<T>> qr_;
  MatrixX<T> A_transposed_;
  Eigen::Index rank_ = 0;
};

}  // namespace dynwitness::recursive
