// SPDX-License-Identifier: Apache-2.0
// The dynamics of a mechanism as a task feels them.
#pragma once

#include "recursive/constrained_dynamics.hpp"

namespace dynwitness::recursive {

/** Jacobian of a task: rows A' J, with A' v the task velocities that the columns of A (wrenches on
    links, as in LinkConstraint; b is not used) single out, A' v = (A' J) qd. By carrying A inward
    through locked joints, O(n m). ws.X_up must be set for this position.
    @param J  m x n on entry, written whole */
template <typename T>
void taskJacobian(const Model<T>& model, const std::vector<LinkConstraint<T>>& tasks,
                  const Workspace<T>& ws, MatrixX<T>& J) {
  J.setConstant(T(0));
  Eigen::Index row = 0;
  for (const LinkConstraint<T>& task : tasks) {
    for (Eigen::Index k = 0; k < task.A.cols(); ++k, ++row) {
      Force<T> f = {task.A.col(k).template head<3>(), task.A.col(k).template tail<3>()};
      for (int i = task.link; i >= 0; i = model.links[i].parent) {
        const LinkModel<T>& link = model.links[i];
        for (int axis = 0; axis < AnyJoints::axes(link); ++axis)
          J(row, link.dof + axis) += AnyJoints::force(link, axis, f);
        f = ws.X_up[i].inverseTimes(f);
      }
    }
  }
}

/** Dynamically consistent inverse of a task Jacobian J = A' J,

        Jbar = M^-1 J' (J M^-1 J')^-1        n x m

    without forming M or J: column k is the acceleration under constraint forces nu that accelerate
    task k by one and the others not at all. O(n m^2 + m^3), after propagateConstraints() and for
    tasks that N (the inverse of the operational inertia) is regular for.

    Among all right inverses of J it is the one that the mass matrix singles out:  J M^-1 (1 - J'
    Jbar') = 0, so joint forces (1 - J' Jbar') tau accelerate no task; and Jbar xd is the velocity
    of least kinetic energy that gives task velocity xd.
    @see O. Khatib, A Unified Approach for Motion and Force Control of Robot Manipulators, IEEE J.
         Robotics and Automation 3 (1987) */
template <typename T>
void dynamicallyConsistentInverse(const Model<T>& model, Workspace<T>& ws,
                                  ConstraintWorkspace<T>& cws, MatrixX<T>& Jbar) {
  requireSize(model, "dynamicallyConsistentInverse", "rows of Jbar", Jbar.rows());
  cws.of_N.factorize(cws.N);
  if (cws.of_N.rank() < cws.count())
    throw std::invalid_argument(
        "dynamicallyConsistentInverse: tasks: expected independent ones, got " +
        std::to_string(cws.count()) + " of rank " + std::to_string(cws.of_N.rank()));
  for (int k = 0; k < cws.count(); ++k) {
    cws.nu.setConstant(T(0));
    cws.nu(k) = T(1);
    cws.of_N.solve(cws.nu);
    accelerationsOfConstraintForces(model, cws.nu, cws, ws, cws.added);
    for (int i = 0; i < model.dof(); ++i) Jbar(i, k) = cws.added[i];
  }
}

/** The part of joint forces that accelerates no task:  tau - J' Jbar' tau, with J and Jbar from
    above. What is left out is the task's share J' (Jbar' tau). */
template <typename T>
void nullSpaceTorque(const MatrixX<T>& J, const MatrixX<T>& Jbar, std::vector<T>& tau) {
  const Eigen::Index m = J.rows(), n = J.cols();
  std::vector<T> force(m, T(0));
  for (Eigen::Index k = 0; k < m; ++k)
    for (Eigen::Index i = 0; i < n; ++i) force[k] += Jbar(i, k) * tau[i];
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < m; ++k) tau[i] -= J(k, i) * force[k];
}

/** Joint forces of an operational-space controller: with the tasks' accelerations b,

        tau = J' Lambda (b - A' a_0) + (1 - J' Jbar') tau_posture,      Lambda = N^-1

    where a_0 is the acceleration at tau = 0. Forward dynamics under tau has A' a = b whatever the
    posture's forces are. The first part is J' nu of constrainedForwardDynamics() at tau = 0: a task
    is a constraint whose ideal force the motors supply.
    @param  tau   the posture's on entry, the controller's on return
    @see O. Khatib (1987), as above */
template <typename T>
void taskTorque(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                const std::vector<T>& qd, const std::vector<LinkConstraint<T>>& tasks,
                Workspace<T>& ws, ConstraintWorkspace<T>& cws, std::vector<T>& tau) {
  requireSize(model, "taskTorque", "tau", tau.size());
  const std::vector<T> none(tau.size(), T(0));
  std::vector<T> qdd = none;
  constrainedForwardDynamics(model, x, qd, none, tasks, ws, cws, qdd);
  const typename ConstraintWorkspace<T>::Vector nu = cws.nu;
  MatrixX<T> J(cws.count(), model.dof()), Jbar(model.dof(), cws.count());
  taskJacobian(model, tasks, ws, J);
  dynamicallyConsistentInverse(model, ws, cws, Jbar);
  nullSpaceTorque(J, Jbar, tau);
  for (int i = 0; i < model.dof(); ++i)
    for (int k = 0; k < cws.count(); ++k) tau[i] += J(k, i) * nu(k);
}

}  // namespace dynwitness::recursive
