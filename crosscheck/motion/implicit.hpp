// SPDX-License-Identifier: GPL-3.0-or-later
// Closed mechanisms of index 1, 2 and 3 by an implicit Runge-Kutta method.
#pragma once

#include <Eigen/LU>

#include "crosscheck/motion/closed_motion.hpp"

namespace dynwitness::crosscheck {

/** Radau IIA with 1 (implicit Euler), 2 or 3 stages, steps as asked.

    A step of length h is a polynomial of degree s for q and qd that fulfils the equations at the
    nodes c_i:

        (1)  Q_i = q_0 + h sum_j a_ij q'_j,   V_i = qd_0 + h sum_j a_ij qd'_j
        (2)  q'_i = rates of V_i (of V_i - J' mu_i: Gear, Leimkuhler and Gupta)
        (3)  M qd'_i + bias - Q_i - J' lambda_i = 0
        (4)  phi'' = 0, phi' = 0, phi = 0, or the last two

    with a_ij from  sum_j a_ij c_j^(k-1) = c_i^k / k,  k = 1..s,  and c the zeros of Radau's
    polynomial; c_s = 1, so that the last stage is the end of the step and fulfils the constraints.
    Newton's method on all stages, its matrix by differences and kept as long as the updates fall;
    it ends where they fall no more, which is rounding. Rows (4) are divided by the powers of h that
    make them as large as the others (Petzold and Loetstedt).

    Order of the error at equal steps, s stages: index 1 and 2, q and qd 2 s - 1, lambda s (index
    2); index 3, q 2 s - 1, qd s, lambda s - 1 (for s > 1).
    @see E. Hairer, G. Wanner, Solving Ordinary Differential Equations II (1996), sections IV.5,
      VII.4 to VII.6;
         C. W. Gear, B. Leimkuhler, G. K. Gupta, J. Comp. Appl. Math. 12-13 (1985) 77-90 */
class RadauIIA {
 public:
  RadauIIA(ClosedMotion& motion, int stages, Formulation formulation);

  /// First guess of accelerations and multipliers.
  void start(const ClosedMotion::State& y, double time);
  /// @throws std::runtime_error  Newton's method does not converge: the step is too long
  void step(ClosedMotion::State* y, double time, double end);
  /// Multipliers of all equations at the end of the last step; zero where a row is left out.
  const Eigen::VectorXd& multipliers() const { return lambda_; }

 private:
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;

  /// (2) to (4) at one stage, for its position, rate and the stage's unknowns.
  Vector residual(const ClosedMotion::State& at, const Vector& unknown, double time, double h,
                  double* power = nullptr);
  ClosedMotion::State stage(const ClosedMotion::State& from, const Vector& unknowns, int i,
                            double h) const;
  void linearize(const ClosedMotion::State& y, const Vector& unknowns, double time, double h);
  bool solve(const ClosedMotion::State& y, double time, double h, Vector* unknowns);
  int size() const;  ///< unknowns of a stage

  ClosedMotion& motion_;
  int s_;
  Formulation formulation_;
  std::vector<double> c_;
  Matrix A_;
  Vector last_, lambda_;  ///< unknowns of the last stage; multipliers
  Eigen::PartialPivLU<Matrix> lu_;
  double linearized_for_ = 0;  ///< h of lu_, 0: none
  std::vector<int> rows_;      ///< equations that lu_ is for
};

}  // namespace dynwitness::crosscheck
