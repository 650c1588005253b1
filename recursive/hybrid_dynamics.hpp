// SPDX-License-Identifier: Apache-2.0
// Some joints' accelerations given, the forces of the others: driven joints, prescribed bases.
#pragma once

#include "recursive/constrained_dynamics.hpp"
#include "recursive/energy.hpp"
#include "recursive/newton_euler.hpp"

namespace dynwitness::recursive {

/** Hybrid dynamics: with the accelerations of some joints and the forces of the others, the rest,
    under constraints on links as in constrainedForwardDynamics().

        M qdd + c + g = tau + Q + J' A nu,      A' (J qdd + dJ/dt qd) + C nu = b

    The articulated-body sweeps with one change: a joint whose acceleration is given hands on the
    inertia of its subtree whole, without projecting it, and its acceleration as if it were velocity
    products,

        M_A of p  +=  X' M_A X,      f_A of p  +=  X' (f_A + M_A (c + Z qdd))

    so that a driven joint may carry what a free one may not (no mass at all), and its inertia is in
    nobody's way. Then one sweep of Newton and Euler for the forces of the driven joints, J' A nu
    taken off.

    @param  driven  by degree of freedom, not 0: qdd is given and tau wanted
    @param  qdd, tau  length n; what is given on entry, both complete on return. nu is left in cws
    @throws std::invalid_argument  sizes do not fit
    @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), section 9.1 */
template <typename T>
void hybridDynamics(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                    const std::vector<T>& qd, const std::vector<char>& driven,
                    const std::vector<LinkConstraint<T>>& constraints, Workspace<T>& ws,
                    ConstraintWorkspace<T>& cws, std::vector<T>& qdd, std::vector<T>& tau,
                    Terms terms = Terms::all()) {
  requirePositions(model, "hybridDynamics", x.size());
  requireSize(model, "hybridDynamics", "qd", qd.size());
  requireSize(model, "hybridDynamics", "driven", driven.size());
  requireSize(model, "hybridDynamics", "qdd", qdd.size());
  requireSize(model, "hybridDynamics", "tau", tau.size());
  requireOwnRates(model, "hybridDynamics");
  const int n = static_cast<int>(model.links.size());
  Motion<T> a_0 = Motion<T>::zero();
  if (terms.gravity) a_0.linear = -model.gravity;

  // outward: velocities, and what each link alone brings
  linkVelocities(model, x, qd, ws);
  for (int i = 0; i < n; ++i) {
    const LinkModel<T>& link = model.links[i];
    ws.c[i] = cross(ws.v[i], AnyJoints::motion(link, qd));
    ws.M_A[i] = ArticulatedInertia<T>::fromRigid(link.M);
    ws.f[i] = biasForce(link.M, ws.v[i]);
  }
  if (terms.loads) subtractLoads(model, ws, ws.f);

  // inward: what each link feels of its subtree
  for (int i = n - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    ArticulatedInertia<T> M_a = ws.M_A[i];
    Force<T> f_a = ws.f[i];
    for (int k = 0, d = link.dof; k < AnyJoints::axes(link); ++k, ++d) {
      if (driven[d]) {
        Motion<T> given = Motion<T>::zero();
        AnyJoints::addMotion(link, k, qdd[d], given);
        f_a = f_a + M_a * given;
        if (model.gyroscopic && link.parent >= 0) f_a = f_a + spinAxis(link) * qdd[d];
        continue;
      }
      ws.U[d] = AnyJoints::column(link, k, M_a);
      ws.D[d] = link.rotor + AnyJoints::force(link, k, ws.U[d]);
      ws.u[d] = tau[d] - AnyJoints::force(link, k, f_a);
      if (terms.springs)
        ws.u[d] -= link.stiffness * (x[link.slot + link.spring_from].q - link.rest);
      if (model.friction && terms.friction) ws.u[d] -= frictionForce(link, qd[d]);
      if (model.gyroscopic && link.parent >= 0) ws.U[d] = ws.U[d] + spinAxis(link);
      const T inverse_D = T(1) / ws.D[d];
      M_a = M_a.minusOuter(ws.U[d], inverse_D);
      f_a = f_a + ws.U[d] * (ws.u[d] * inverse_D);
    }
    if (link.parent >= 0) {
      if (model.gyroscopic && link.dof >= 0)
        f_a = f_a + spinForce(link, qd[link.dof], T(0), ws.X_up[i] * ws.v[link.parent]);
      ws.M_A[link.parent] = ws.M_A[link.parent] + ws.X_up[i].inverseTimes(M_a);
      ws.f[link.parent] = ws.f[link.parent] + ws.X_up[i].inverseTimes(f_a + M_a * ws.c[i]);
    }
  }

  // outward: accelerations
  for (int i = 0; i < n; ++i) {
    const LinkModel<T>& link = model.links[i];
    ws.a[i] = ws.X_up[i] * (link.parent < 0 ? a_0 : ws.a[link.parent]) + ws.c[i];
    for (int k = AnyJoints::axes(link) - 1, d = link.dof + k; k >= 0; --k, --d) {
      if (!driven[d]) qdd[d] = (ws.u[d] - dot(ws.a[i], ws.U[d])) / ws.D[d];
      AnyJoints::addMotion(link, k, qdd[d], ws.a[i]);
    }
  }
  addConstraintForces(model, constraints, terms.gravity, ws, cws, qdd, driven);

  // the forces of the driven joints
  std::vector<T>& all = cws.added;
  inverseDynamics(model, x, qd, qdd, ws, all, terms);
  for (Force<T>& f : ws.f) f = Force<T>::zero();
  int row = 0;
  for (const LinkConstraint<T>& constraint : constraints)
    for (Eigen::Index k = 0; k < constraint.A.cols(); ++k, ++row) {
      const Force<T> unit = {constraint.A.col(k).template head<3>(),
                             constraint.A.col(k).template tail<3>()};
      ws.f[constraint.link] = ws.f[constraint.link] + unit * cws.nu(row);
    }
  for (int i = n - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    for (int k = 0, d = link.dof; k < AnyJoints::axes(link); ++k, ++d)
      if (driven[d]) tau[d] = all[d] - AnyJoints::force(link, k, ws.f[i]);
    if (link.parent >= 0) ws.f[link.parent] = ws.f[link.parent] + ws.X_up[i].inverseTimes(ws.f[i]);
  }
}

}  // namespace dynwitness::recursive
