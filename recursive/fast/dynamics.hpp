// SPDX-License-Identifier: Apache-2.0
// The fast sweeps of one mechanism, in double: angles in, forces, masses or accelerations out.
#pragma once

#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/inverse_dynamics.hpp"
#include "recursive/fast/mass_matrix.hpp"
#include "recursive/fast/sine_cosine.hpp"

namespace dynwitness::recursive::fast {

/** A mechanism that is decided when the program runs, made ready once, then asked at many states.

    q [rad, m] has model.positions numbers; qd, qdd, tau have model.dof() each, M the square of that
    (symmetric: rows or columns). No call allocates. One object serves one thread. */
class Dynamics {
 public:
  explicit Dynamics(const Model<double>& model)
      : plan_(model), x_(plan_.positions), id_(plan_), m_(plan_), fd_(plan_) {}

  const Plan<double>& plan() const { return plan_; }

  /// tau of M qdd + c + g - Q
  void inverseDynamics(const double* q, const double* qd, const double* qdd, double* tau) {
    jointPositions(q, plan_.positions, x_.data());
    fast::inverseDynamics(plan_, x_.data(), qd, qdd, id_, tau);
  }
  void massMatrix(const double* q, double* M) {
    jointPositions(q, plan_.positions, x_.data());
    fast::massMatrix(plan_, x_.data(), m_, M);
  }
  /// qdd of M qdd + c + g = tau + Q
  void forwardDynamics(const double* q, const double* qd, const double* tau, double* qdd) {
    jointPositions(q, plan_.positions, x_.data());
    fast::forwardDynamics(plan_, x_.data(), qd, tau, fd_, qdd);
  }

  /// The joints' positions of the last call.
  const JointPosition<double>* positions() const { return x_.data(); }
  /// U and 1 / D of a rate, as the last forwardDynamics() left them.
  const ForwardDynamicsWorkspace<double>::Joint& joint(int rate) const { return fd_.joints[rate]; }

 private:
  Plan<double> plan_;
  std::vector<JointPosition<double>> x_;
  InverseDynamicsWorkspace<double> id_;
  MassMatrixWorkspace<double> m_;
  ForwardDynamicsWorkspace<double> fd_;
};

}  // namespace dynwitness::recursive::fast
