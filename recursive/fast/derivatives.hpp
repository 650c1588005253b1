// SPDX-License-Identifier: Apache-2.0
// Derivatives of one mechanism's inverse and forward dynamics, in double: angles in, matrices out.
#pragma once

#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/forward_dynamics_derivatives.hpp"
#include "recursive/fast/sine_cosine.hpp"

namespace dynwitness::recursive::fast {

/** A mechanism that is decided when the program runs, made ready once, then asked at many states.

    Positions, rates and conventions are those of fast::Dynamics and
    recursive::inverseDynamicsDerivatives; every matrix is n x n, row by row. No call allocates. One
    object serves one thread. */
class Derivatives {
 public:
  explicit Derivatives(const Model<double>& model)
      : plan_(model), x_(plan_.positions), qdd_(plan_.dof), fd_(plan_), room_(plan_) {}

  const Plan<double>& plan() const { return plan_; }

  /// Of tau, with d tau/dqdd = M.
  void inverseDynamics(const double* q, const double* qd, const double* qdd, double* dtau_dq,
                       double* dtau_dqd, double* M) {
    jointPositions(q, plan_.positions, x_.data());
    const std::size_t n = plan_.dof;
    inverseDynamicsDerivatives(plan_, x_.data(), qd, qdd, room_.of_tau,
                               {dtau_dq, dtau_dqd, n, M, n});
  }
  /// Of qdd, which is computed on the way, with d qdd/dtau = 1/M.
  void forwardDynamics(const double* q, const double* qd, const double* tau, double* dqdd_dq,
                       double* dqdd_dqd, double* dqdd_dtau) {
    jointPositions(q, plan_.positions, x_.data());
    fast::forwardDynamics(plan_, x_.data(), qd, tau, fd_, qdd_.data());
    forwardDynamicsDerivatives(plan_, x_.data(), qd, qdd_.data(), room_,
                               {dqdd_dq, dqdd_dqd, dqdd_dtau});
  }
  /// qdd of the last forwardDynamics().
  const double* qdd() const { return qdd_.data(); }

 private:
  Plan<double> plan_;
  std::vector<JointPosition<double>> x_;
  std::vector<double> qdd_;
  ForwardDynamicsWorkspace<double> fd_;
  AccelerationDerivativesWorkspace<double> room_;
};

}  // namespace dynwitness::recursive::fast
