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
          J(row, link.dof + axis) = AnyJoints::force(link, axis, f);
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
    Jbar') = 0, so joint forces (1 - J' Jbar') tau accelerate no task; and Jbar xd is the velocity of
    least kinetic energy that gives task velocity xd.
    @see O. Khatib, A Unified Approach for Motion and Force Control of Robot Manipulators, IEEE J.
         Robotics and Automation 3 (1987) */
template <typename T>
void dynamicallyConsistentInverse(const Model<T>& model, Workspace<T>& ws,
                                  ConstraintWorkspace<T>& cws, MatrixX<T>& Jbar) {
  requireSize(model, "dynamicallyConsistentInverse", "rows of Jbar", Jbar.rows());
  cws.LDL = cws.N;
  factorize(cws.LDL);
  for (int k = 0; k < cws.count(); ++k) {
    cws.nu.setConstant(T(0));
    cws.nu(k) = T(1);
    solve(cws.LDL, cws.nu);
    accelerationsOfConstraintForces(model, cws.nu, cws, ws, cws.added);
    for (int i = 0; i < model.dof(); ++i) Jbar(i, k) = cws.added[i];
  }
}

}  // namespace dynwitness::recursive
