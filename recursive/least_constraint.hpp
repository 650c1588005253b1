// SPDX-License-Identifier: Apache-2.0
// Gauss' principle of least constraint as a problem of its own, and at the base of a floating
// robot.
#pragma once

#include <stdexcept>
#include <vector>

#include "recursive/articulated_body.hpp"
#include "recursive/constrained_dynamics.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::recursive {

template <typename T>
struct LeastConstraint {
  Eigen::Matrix<T, Eigen::Dynamic, 1> a, force;  ///< accelerations n, forces of the constraints k
  std::vector<char> determined;                  ///< by force
  Eigen::Matrix<T, Eigen::Dynamic, 1>
      contradiction;  ///< by constraint, zero where one can be obeyed
};

/** The acceleration a that makes

        1/2 a' M a + F' a    smallest under   A' a = b

    M n x n positive definite, A n x k of any rank: with a_free = -M^-1 F

        M a + F = A force,      (A' M^-1 A) force = b - A' a_free

    For a mechanism, F is minus the force that acts, and the sum is Gauss' measure of constraint,
    half the square of the distance from the free motion in M's norm, up to a constant.
    @see C. F. Gauss (1829) */
template <typename T>
LeastConstraint<T> leastConstraint(const MatrixX<T>& M,
                                   const Eigen::Matrix<T, Eigen::Dynamic, 1>& F,
                                   const MatrixX<T>& A,
                                   const Eigen::Matrix<T, Eigen::Dynamic, 1>& b) {
  if (M.rows() != M.cols() || F.size() != M.rows() || A.rows() != M.rows() || b.size() != A.cols())
    throw std::invalid_argument(
        "leastConstraint: M, F, A, b: expected n x n, n, n x k and k numbers");
  MatrixX<T> LDL = M;
  factorize(LDL);
  LeastConstraint<T> out;
  out.a = -F;
  solve(LDL, out.a);
  MatrixX<T> M_inverse_A = A;
  for (Eigen::Index k = 0; k < A.cols(); ++k) {
    Eigen::Matrix<T, Eigen::Dynamic, 1> column = A.col(k);
    solve(LDL, column);
    M_inverse_A.col(k) = column;
  }
  SemidefiniteSolver<T> solver(static_cast<int>(A.cols()));
  solver.factorize(A.transpose() * M_inverse_A);
  out.force = b - A.transpose() * out.a;
  out.contradiction = solver.solve(out.force);
  out.determined = solver.determined();
  out.a += M_inverse_A * out.force;
  return out;
}

/** Forward dynamics of a floating robot (link 0) whose base is constrained, A_0' a_0 = b_0 as in
    LinkConstraint: the inward sweep of forwardDynamics() leaves one body with inertia M_A,0 and
    bias force F_0, whose accelerations are those of least constraint; the outward sweep gives the
    joints theirs. One system of six unknowns, whatever hangs on the base.
    @throws std::invalid_argument  link 0 does not float, or the constraint is not on it */
template <typename T>
void baseConstrainedDynamics(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                             const std::vector<T>& qd, const std::vector<T>& tau,
                             const LinkConstraint<T>& base, Workspace<T>& ws, std::vector<T>& qdd,
                             Eigen::Matrix<T, Eigen::Dynamic, 1>* force) {
  if (model.links.empty() || model.links[0].kind != JointKind::kFloating || base.link != 0)
    throw std::invalid_argument(
        "baseConstrainedDynamics: expected a floating link 0, and a constraint on it");
  requireOwnRates(model, "baseConstrainedDynamics");
  forwardDynamics(model, x, qd, tau, ws, qdd);
  MatrixX<T> M(6, 6), A = base.A;
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  Vector F(6);
  for (int k = 0; k < 6; ++k) {
    Motion<T> unit = Motion<T>::zero();
    AnyJoints::addMotion(model.links[0], k, T(1), unit);
    M.col(k) = (ws.M_A[0] * unit).vector();
    F(k) = AnyJoints::force(model.links[0], k, ws.f[0]) - tau[k];
  }
  // accelerations as the sweep carries them: without c and gravity's share, which are known
  Motion<T> a_0 = Motion<T>::zero();
  a_0.linear = -model.gravity;
  const Motion<T> known = ws.X_up[0] * a_0 + ws.c[0],
                  gravity = {ws.X_up[0].R * model.gravity, Vector3<T>::Zero()};
  const Vector known6 = known.vector(), offset = (known + gravity).vector();
  const LeastConstraint<T> best =
      leastConstraint<T>(M, Vector(F + M * known6), A, Vector(base.b - A.transpose() * offset));
  *force = best.force;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const LinkModel<T>& link = model.links[i];
    // others may stand on the world beside the base
    ws.a[i] = ws.X_up[i] * (link.parent < 0 ? a_0 : ws.a[link.parent]) + ws.c[i];
    for (int k = AnyJoints::axes(link) - 1, d = link.dof + k; k >= 0; --k, --d) {
      qdd[d] = i == 0 ? best.a(k) : T((ws.u[d] - dot(ws.a[i], ws.U[d])) / ws.D[d]);
      AnyJoints::addMotion(link, k, qdd[d], ws.a[i]);
    }
  }
}

}  // namespace dynwitness::recursive
