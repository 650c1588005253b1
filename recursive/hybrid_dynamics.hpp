// SPDX-License-Identifier: Apache-2.0
// Some joints' accelerations given, the forces of the others: driven joints, prescribed bases.
#pragma once

#include "recursive/articulated_step.hpp"
#include "recursive/constrained_dynamics.hpp"
#include "recursive/newton_euler.hpp"

namespace dynwitness::recursive {

/// By degree of freedom: 1 where a drive gives the motion.
inline std::vector<char> drivenRates(const scene::Mechanism& mechanism) {
  std::vector<char> driven;
  for (const scene::Expression* motion : mechanism.motions()) driven.push_back(motion ? 1 : 0);
  return driven;
}

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
  ArticulatedSteps<AnyJoints, T> step(model, x, qd, terms, ws);

  // outward: velocities, and what each link alone brings
  step.start();

  // inward: what each link feels of its subtree
  for (int i = n - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    ArticulatedBody<T> body = step.body(i);
    for (int k = 0, d = link.dof; k < AnyJoints::axes(link); ++k, ++d) {
      if (driven[d]) {
        step.passGiven(i, k, qdd[d], body);
        continue;
      }
      step.formEquation(i, k, d, tau[d], body);
      step.project(d, body);
    }
    step.handOn(i, body);
  }

  // outward: accelerations
  for (int i = 0; i < n; ++i)
    step.accelerate(i, qdd, [&](int d) { return driven[d] ? qdd[d] : step.acceleration(i, d); });
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
