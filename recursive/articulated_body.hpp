// SPDX-License-Identifier: Apache-2.0
// Forward dynamics by articulated-body sweeps.
#pragma once

#include <vector>

#include "recursive/articulated_step.hpp"
#include "recursive/coupled_dynamics.hpp"

namespace dynwitness::recursive {

/** Forward dynamics: the qdd that solves M(q) qdd + c(q, qd) + g(q) + friction = tau + Q, by three
    sweeps over articulated inertias, in O(n).

    The steps, (1) to (6), are those of articulated_step.hpp.

    @param  x, qd, tau  position, velocity [rad/s, m/s], joint force [N m, N], length n
    @param  qdd   accelerations, length n [rad/s^2, m/s^2]
    @param  terms gravity, springs, loads and friction can be left out
    @throws std::invalid_argument  a vector is not of length n
    Joints that follow others, and rotors geared to several rates: coupled_dynamics.hpp, which
    allocates.
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

  withJoints(model, [&](auto joints) {
    using Joints = decltype(joints);
    ArticulatedSteps<Joints, T> step(model, x, qd, terms, ws);
    // outward: velocities, and what each link alone brings
    step.start();  // (1), (2)

    // inward: what each link feels of its subtree
    for (int i = n - 1; i >= 0; --i) {
      const LinkModel<T>& link = model.links[i];
      ArticulatedBody<T> body = step.body(i);
      for (int k = 0, d = link.dof; k < Joints::axes(link); ++k, ++d) {
        step.formEquation(i, k, d, tau[d], body);  // (3)
        step.project(d, body);
      }
      step.handOn(i, body);  // (4), (5)
    }

    // outward: accelerations
    for (int i = 0; i < n; ++i)
      step.accelerate(i, qdd, [&](int d) { return step.acceleration(i, d); });  // (6)
  });
}

}  // namespace dynwitness::recursive
