// SPDX-License-Identifier: Apache-2.0
// Forward dynamics of a mechanism with closed loops, in double: M by the fast sweeps and factored
// along the tree.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "recursive/constraints.hpp"
#include "recursive/fast/inverse_dynamics.hpp"
#include "recursive/fast/mass_matrix.hpp"
#include "recursive/fast/sine_cosine.hpp"
#include "recursive/point_springs.hpp"
#include "recursive/semidefinite.hpp"
#include "recursive/tree_factorization.hpp"

namespace dynwitness::recursive::fast {

/** A mechanism with closures that is decided when the program runs, made ready once, then asked at
    many states:

        (1)  M qdd + bias = tau + J' lambda,    J qdd + gamma = 0
        (2)  M = L' D L,  L a unit lower triangle where joint j is inboard of joint i, else zero
        (3)  Y = L'^-1 J',   y = L'^-1 (tau - bias)
        (4)  N = Y' D^-1 Y,   N lambda = -gamma - Y' D^-1 y
        (5)  qdd = L^-1 D^-1 (y + Y lambda)

    Where the tree has zeros, nothing is computed: Y is done on the ways from the closures to the
    world alone. Equations that depend on others are found in N (SemidefiniteSolver). No call
    allocates. One object serves one thread. Drives and acceleration constraints it does not know.
    closedForwardDynamics() eliminates loops where they close instead, in O(n).

    N has the square of the condition that the closures have: where these are nearly redundant or
    contradict each other, half as many digits are left as solving (1) whole leaves, and nothing
    warns. It is for closures that are not.

    @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), section 6.5, for (2) */
class ClosedDynamics {
 public:
  /// @param closures  of the model
  /// @throws std::invalid_argument  joints follow others, or rotors are geared to several rates
  ClosedDynamics(const Model<double>& model, Constraints<double> closures,
                 std::vector<PointSpring<double>> springs = {})
      : model_(model),
        closures_(std::move(closures)),
        springs_(std::move(springs)),
        ws_(model_),
        plan_(model_),
        of_bias_(plan_),
        of_M_(plan_),
        x_(model_.positions),
        inboard_(recursive::inboardRates(model_)),
        run_(firstOfRuns(inboard_)),
        qd_(model_.dof()),
        pull_(model_.dof()),
        at_rest_(model_.dof(), 0.0),
        bias_(model_.dof()),
        y_(model_.dof()),
        is_seen_(model_.dof()),
        M_(static_cast<std::size_t>(model_.dof()) * model_.dof()),
        Y_(static_cast<std::size_t>(model_.dof()) * closures_.rows()),
        N_(MatrixX<double>::Zero(closures_.rows(), closures_.rows())),
        lambda_(VectorX<double>::Zero(closures_.rows())),
        of_N_(closures_.rows()) {}

  /** qdd of (1), springs between points and loads in it.
      @param q  model.positions numbers; qd, tau, qdd  model.dof() each
      @throws std::domain_error  M is not positive definite */
  void forwardDynamics(const double* q, const double* qd, const double* tau, double* qdd) {
    const int n = model_.dof();
    jointPositions(q, model_.positions, x_.data());
    std::copy_n(qd, n, qd_.begin());
    constraintEquations(model_, x_, qd_, ws_, closures_);
    std::copy_n(tau, n, pull_.begin());
    addSpringForces(model_, springs_, closures_.X_W, ws_, pull_);
    fast::inverseDynamics(plan_, x_.data(), qd, at_rest_.data(), of_bias_, bias_.data());
    fast::massMatrix(plan_, x_.data(), of_M_, M_.data());
    factorize();
    for (int i = 0; i < n; ++i) y_[i] = pull_[i] - bias_[i];
    toJoints();
    solveLoops();
    for (int i = 0; i < n; ++i) {
      double force = y_[i];
      if (is_seen_[i])
        for (int k = 0; k < closures_.rows(); ++k) force += Y(i)[k] * lambda_(k);
      qdd[i] = force / M(i)[i];
      const double* const L = M(i);
      forInboard(inboard_[i], [&](int first, int last) {
        for (int j = first; j <= last; ++j) qdd[i] -= L[j] * qdd[j];  // (5)
      });
    }
  }

  /// Of the last state: by closure equation, those that depend on others zero.
  const VectorX<double>& multipliers() const { return lambda_; }
  int rank() const { return of_N_.rank(); }
  /// phi, J, gamma of the last state.
  const Constraints<double>& closures() const { return closures_; }

 private:
  double* M(int i) { return &M_[static_cast<std::size_t>(i) * model_.dof()]; }
  double* Y(int i) { return &Y_[static_cast<std::size_t>(i) * closures_.rows()]; }

  /// By rate: the first of consecutive ones that ends with it, each inboard of the next.
  static std::vector<int> firstOfRuns(const std::vector<int>& inboard) {
    std::vector<int> first(inboard.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      first[i] =
          i > 0 && inboard[i] == static_cast<int>(i) - 1 ? first[i - 1] : static_cast<int>(i);
    return first;
  }
  /// Calls f(first, last) for runs of rate i and all inboard of it, the outermost run first.
  template <typename F>
  DYNWITNESS_INLINE void forInboard(int i, const F& f) const {
    for (; i >= 0; i = inboard_[run_[i]]) f(run_[i], i);
  }

  /// (2): D on the diagonal of M, L below it.
  void factorize() {
    for (int k = model_.dof() - 1; k >= 0; --k) {
      double* const row = M(k);
      if (!(row[k] > 0))
        throw std::domain_error("ClosedDynamics: M: expected a positive definite matrix");
      const double inverse = 1 / row[k];
      forInboard(inboard_[k], [&](int first_of_row, int last_of_row) {
        for (int i = last_of_row; i >= first_of_row; --i) {
          const double l = row[i] * inverse;
          double* const above = M(i);
          forInboard(i, [&](int first, int last) {
            for (int j = first; j <= last; ++j) above[j] -= row[j] * l;
          });
          row[i] = l;
        }
      });
    }
  }

  /// (3)
  void toJoints() {
    const int n = model_.dof(), m = closures_.rows();
    for (int i = 0; i < n; ++i) {
      is_seen_[i] = 0;
      for (int k = 0; k < m; ++k) {
        Y(i)[k] = closures_.J(k, i);
        if (Y(i)[k] != 0) is_seen_[i] = 1;
      }
    }
    for (int i = n - 1; i >= 0; --i) {
      const double* const L = M(i);
      const double y = y_[i];
      forInboard(inboard_[i], [&](int first, int last) {
        for (int j = first; j <= last; ++j) y_[j] -= L[j] * y;
        if (!is_seen_[i]) return;
        const double* const from = Y(i);
        for (int j = first; j <= last; ++j) {
          double* const to = Y(j);
          for (int k = 0; k < m; ++k) to[k] -= L[j] * from[k];
          is_seen_[j] = 1;
        }
      });
    }
  }

  /// (4)
  void solveLoops() {
    const int m = closures_.rows();
    N_.setZero();
    lambda_ = -closures_.gamma;
    for (int i = 0; i < model_.dof(); ++i) {
      if (!is_seen_[i]) continue;
      const double inverse = 1 / M(i)[i];
      for (int k = 0; k < m; ++k) {
        const double of_k = Y(i)[k] * inverse;
        lambda_(k) -= of_k * y_[i];
        for (int l = 0; l <= k; ++l) N_(l, k) += of_k * Y(i)[l];
      }
    }
    for (int k = 0; k < m; ++k)
      for (int l = 0; l < k; ++l) N_(k, l) = N_(l, k);
    of_N_.factorize(N_);
    of_N_.solve(lambda_);
  }

  Model<double> model_;
  Constraints<double> closures_;
  std::vector<PointSpring<double>> springs_;
  Workspace<double> ws_;
  Plan<double> plan_;
  InverseDynamicsWorkspace<double> of_bias_;
  MassMatrixWorkspace<double> of_M_;
  std::vector<JointPosition<double>> x_;
  std::vector<int> inboard_, run_;
  std::vector<double> qd_, pull_, at_rest_, bias_, y_;
  std::vector<char> is_seen_;  ///< by rate: its row of Y is not zero
  std::vector<double> M_, Y_;  ///< row by row
  MatrixX<double> N_;
  VectorX<double> lambda_;
  SemidefiniteSolver<double> of_N_;
};

}  // namespace dynwitness::recursive::fast
