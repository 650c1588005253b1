// SPDX-License-Identifier: Apache-2.0
// Inverse dynamics by the recursive Newton-Euler sweeps.
#pragma once

#include <vector>

#include "recursive/joint_forces.hpp"

namespace dynwitness::recursive {

/** Inverse dynamics, tau = M(q) qdd + c(q, qd) + g(q) + friction - Q, by an outward sweep of motion
    and an inward sweep of force (recursive Newton-Euler), in O(n).

    With p the parent of link i, Z the joint's axes, X the transformation from p to i, everything in
    the coordinates of link i, where Z is constant:
        (1)  v_i = X v_p + Z qd_i
        (2)  a_i = X a_p + Z qdd_i + v_i x Z qd_i          a_0 = -gravity
        (3)  f_i = M_i a_i + v_i x* (M_i v_i) - loads + sum over children of X' f_child
        (4)  tau_i = Z' f_i + d_i qdd_i + k_i (q_i - rest_i) + friction_i(qd_i)
    a is spatial acceleration; d = n^2 J the rotor's inertia at the joint, k the joint's spring.
    ws.f[i] is f_i afterwards: the whole wrench through the joint.

    A gyroscopic rotor turns about the joint's axis z on the parent, with h = n J: its momentum h qd
    z, seen from the parent, is carried around by the parent, and it feels the parent's rotation
    w_p:
        (5)  f_p also has the moment  h qdd_i z + w_p x h qd_i z
        (6)  tau_i also has  h z' (dw_p/dt)
    A rotor geared to all rates of a joint (GearedRotor), psi' = n'nu, about the axis a of link p:
        (7)  tau += n J (psi'' + a'dw_p/dt),   f_p also has the moment  J psi'' a + w_p x J psi' a
    whatever nu are: the motor's own equation, carried over by its gears (scene::Rotor).

    @tparam T     tested with double, long double, float, running error bounds, dual numbers
    @param  x, qd, qdd   position, velocity [rad/s, m/s], acceleration [rad/s^2, m/s^2], length n
    @param  tau   joint forces, length n [N m, N], positive along the joint's +z
    @param  terms gravity, springs, loads and friction can be left out: c alone is qdd = 0 and
      Terms::none()
    @throws std::invalid_argument  a vector is not of length n
    @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), table 5.1, p. 96 */
template <typename T>
void inverseDynamics(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                     const std::vector<T>& qd, const std::vector<T>& qdd, Workspace<T>& ws,
                     std::vector<T>& tau, Terms terms = Terms::all()) {
  requirePositions(model, "inverseDynamics", x.size());
  requireSize(model, "inverseDynamics", "qd", qd.size());
  requireSize(model, "inverseDynamics", "qdd", qdd.size());
  requireSize(model, "inverseDynamics", "tau", tau.size());
  const int n = static_cast<int>(model.links.size());
  const Motion<T> v_0 = Motion<T>::zero();
  Motion<T> a_0 = Motion<T>::zero();
  if (terms.gravity) a_0.linear = -model.gravity;

  withJoints(model, [&](auto joints) {
    using Joints = decltype(joints);
    // outward: velocities, accelerations, and the force that each link alone needs
    for (int i = 0; i < n; ++i) {
      const LinkModel<T>& link = model.links[i];
      const int p = link.parent;
      ws.X_up[i] = Joints::transform(link, x);
      const Motion<T> v_J = Joints::motion(link, qd);
      ws.v[i] = ws.X_up[i] * (p < 0 ? v_0 : ws.v[p]) + v_J;  // (1)
      ws.a[i] = ws.X_up[i] * (p < 0 ? a_0 : ws.a[p]) + Joints::motion(link, qdd) +
                cross(ws.v[i], v_J);                            // (2)
      ws.f[i] = link.M * ws.a[i] + biasForce(link.M, ws.v[i]);  // (3), own part
    }
    if (terms.loads) subtractLoads(model, ws, ws.f);
    for (const GearedRotor<T>& rotor : model.rotors)  // (7)
      if (rotor.carrier >= 0)
        ws.f[rotor.carrier] =
            ws.f[rotor.carrier] +
            spinForce(rotor, rotorRate(rotor, qd), rotorRate(rotor, qdd), ws.v[rotor.carrier]);

    // inward: what passes through each joint
    for (int i = n - 1; i >= 0; --i) {
      const LinkModel<T>& link = model.links[i];
      for (int k = 0, d = link.dof; k < Joints::axes(link); ++k, ++d) {
        const T own = Joints::force(link, k, ws.f[i]) + link.rotor * qdd[d];  // (4)
        if (Joints::kMayFollow && link.adds)
          tau[d] += own;
        else
          tau[d] = own;
      }
      if (link.dof >= 0)
        passiveForces(model, link, link.dof, x, qd, terms,
                      [&](const T& force) { tau[link.dof] += force; });
      if (link.parent < 0) continue;
      Force<T> f = ws.f[i];
      if (spinsOnALink(model, link)) {
        const Motion<T> v_p = ws.X_up[i] * ws.v[link.parent], a_p = ws.X_up[i] * ws.a[link.parent];
        f = f + spinForce(link, qd[link.dof], qdd[link.dof], v_p);  // (5)
        tau[link.dof] += dot(a_p, spinAxis(link));                  // (6)
      }
      ws.f[link.parent] = ws.f[link.parent] + ws.X_up[i].inverseTimes(f);  // (3), children
    }
  });
  for (const GearedRotor<T>& rotor : model.rotors) {  // (7)
    T moment = rotor.inertia * rotorRate(rotor, qdd);
    if (rotor.carrier >= 0) moment += dot(ws.a[rotor.carrier], spinAxis(rotor));
    for (std::size_t k = 0; k < rotor.ratio.size(); ++k)
      tau[rotor.dof + k] += rotor.ratio[k] * moment;
  }
}

}  // namespace dynwitness::recursive
