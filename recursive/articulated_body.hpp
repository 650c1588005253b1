// SPDX-License-Identifier: Apache-2.0
// Forward dynamics by articulated-body sweeps.
#pragma once

#include <vector>

#include "recursive/coupled_dynamics.hpp"
#include "recursive/model.hpp"

namespace dynwitness::recursive {

/** Forward dynamics: the qdd that solves M(q) qdd + c(q, qd) + g(q) + friction = tau + Q, by three
    sweeps over articulated inertias, in O(n).

    With p the parent of link i, Z the joint's axis, constant in link axes, X the transformation
    from p to i:
        (1)  v_i = X v_p + Z qd_i,   c_i = v_i x Z qd_i
        (2)  M_A = M_i,   f_A = v_i x* (M_i v_i) - loads                       at first, own parts
        (3)  U = M_A Z,   D = d + Z' U,   u = tau_i - k (q_i - rest) - friction - Z' f_A
        (4)  M_A of p  +=  X' (M_A - U U' / D) X          the inward projection P M_A
        (5)  f_A of p  +=  X' (f_A + (M_A - U U' / D) c_i + U u / D)
        (6)  qdd_i = (u - U' (X a_p + c_i)) / D,   a_i = X a_p + c_i + Z qdd_i,   a_0 = -gravity
    A joint of several axes is passed one axis at a time, as if there were massless links between:
    (3) sees M_A and f_A as the axes before have left them, and (6) goes through the axes backward.
    Successive eliminations of one axis are the elimination of all, without a matrix to invert. A
    gyroscopic rotor (newton_euler.hpp, (5) and (6)) adds h z'(X a_p) to the joint's equation and (h
    qdd + w_p x h qd) z to the parent's force. With G = (0, h z) that is U + G in place of U in (4),
    (5) and (6), but not in D; and G'c_i = h z'(w_i x z) qd_i = 0, so that nothing else changes.

    @param  x, qd, tau  position, velocity [rad/s, m/s], joint force [N m, N], length n
    @param  qdd   accelerations, length n [rad/s^2, m/s^2]
    @param  terms gravity, springs, loads and friction can be left out
    @throws std::invalid_argument  a vector is not of length n
    Joints that follow others: coupled_dynamics.hpp, which allocates.
    D = 0 (a massless subtree without rotor inertia) divides by zero: scene validation refuses it.
    @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), table 7.1, p. 132 */
template <typename T>
void forwardDynamics(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                     const std::vector<T>& qd, const std::vector<T>& tau, Workspace<T>& ws,
                     std::vector<T>& qdd, Terms terms = Terms::all()) {
  requirePositions(model, "forwardDynamics", x.size());
  requireSize(model, "forwardDynamics", "qd", qd.size());
  requireSize(model, "forwardDynamics", "tau", tau.size());
  requireSize(model, "forwardDynamics", "qdd", qdd.size());
  if (model.coupled) return detail::coupledForwardDynamics(model, x, qd, tau, ws, qdd, terms);
  const int n = static_cast<int>(model.links.size());
  Motion<T> a_0 = Motion<T>::zero();
  if (terms.gravity) a_0.linear = -model.gravity;

  withJoints(model, [&](auto joints) {
    using Joints = decltype(joints);
    // outward: velocities, and what each link alone brings
    for (int i = 0; i < n; ++i) {
      const LinkModel<T>& link = model.links[i];
      const int p = link.parent;
      ws.X_up[i] = Joints::transform(link, x);
      const Motion<T> v_J = Joints::motion(link, qd);
      ws.v[i] = p < 0 ? v_J : ws.X_up[i] * ws.v[p] + v_J;
      ws.c[i] = cross(ws.v[i], v_J);  // (1)
      ws.M_A[i] = ArticulatedInertia<T>::fromRigid(link.M);
      ws.f[i] = biasForce(link.M, ws.v[i]);  // (2)
    }
    if (terms.loads) subtractLoads(model, ws, ws.f);

    // inward: what each link feels of its subtree
    for (int i = n - 1; i >= 0; --i) {
      const LinkModel<T>& link = model.links[i];
      ArticulatedInertia<T> M_a = ws.M_A[i];
      Force<T> f_a = ws.f[i];
      for (int k = 0, d = link.dof; k < Joints::axes(link); ++k, ++d) {
        ws.U[d] = Joints::column(link, k, M_a);  // (3)
        ws.D[d] = link.rotor + Joints::force(link, k, ws.U[d]);
        ws.u[d] = tau[d] - Joints::force(link, k, f_a);
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
        ws.M_A[link.parent] = ws.M_A[link.parent] + ws.X_up[i].inverseTimes(M_a);  // (4)
        ws.f[link.parent] =
            ws.f[link.parent] + ws.X_up[i].inverseTimes(f_a + M_a * ws.c[i]);  // (5)
      }
    }

    // outward: accelerations
    for (int i = 0; i < n; ++i) {
      const LinkModel<T>& link = model.links[i];
      ws.a[i] = ws.X_up[i] * (link.parent < 0 ? a_0 : ws.a[link.parent]) + ws.c[i];
      for (int k = Joints::axes(link) - 1, d = link.dof + k; k >= 0; --k, --d) {
        qdd[d] = (ws.u[d] - dot(ws.a[i], ws.U[d])) / ws.D[d];  // (6)
        Joints::addMotion(link, k, qdd[d], ws.a[i]);
      }
    }
  });
}

}  // namespace dynwitness::recursive
