// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/traced_sweeps.hpp"

#include "recursive/articulated_body.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/newton_euler.hpp"

namespace dynwitness::crosscheck::kernel {

std::vector<Traced> tracedSweep(const recursive::Model<Traced>& model, Formula formula,
                                const scene::State<Traced>& state) {
  using recursive::Terms;
  recursive::Workspace<Traced> ws(model);
  const std::vector<Traced> none(model.dof(), Traced(0));
  std::vector<Traced> out(none);
  switch (formula) {
    case Formula::kInverseDynamics:
      recursive::inverseDynamics(model, state.x, state.qd, state.qdd, ws, out);
      return out;
    case Formula::kCoriolis:
      recursive::inverseDynamics(model, state.x, state.qd, none, ws, out, Terms::none());
      return out;
    case Formula::kGravity:
      recursive::inverseDynamics(model, state.x, none, none, ws, out, Terms::potential());
      return out;
    case Formula::kMassMatrix: {
      recursive::MatrixX<Traced> M(model.dof(), model.dof());
      recursive::massMatrix(model, state.x, ws, M);
      return {M.data(), M.data() + M.size()};  // symmetric: by columns is by rows
    }
    case Formula::kMassCoriolisGravity: {
      std::vector<Traced> all = tracedSweep(model, Formula::kMassMatrix, state);
      for (const Formula more : {Formula::kCoriolis, Formula::kGravity}) {
        const std::vector<Traced> values = tracedSweep(model, more, state);
        all.insert(all.end(), values.begin(), values.end());
      }
      return all;
    }
    case Formula::kForwardDynamics:
      recursive::forwardDynamics(model, state.x, state.qd, state.tau, ws, out);
      return out;
  }
  return {};
}

recursive::Model<Traced> recursiveModel(const LeanModel& lean) {
  recursive::Model<Traced> model;
  model.gravity = lean.gravity;
  model.link_of_dof.resize(lean.links.size());
  model.positions = static_cast<int>(lean.links.size());
  for (std::size_t i = 0; i < lean.links.size(); ++i) {
    const LeanLink& link = lean.links[i];
    recursive::LinkModel<Traced> out;
    out.parent = link.parent;
    out.dof = link.dof;
    out.slot = link.slot;
    out.kind = link.turns ? scene::JointKind::kRevolute : scene::JointKind::kPrismatic;
    out.X_tree = {link.R, link.p};
    const Symmetric3& S = link.S;
    out.M = {link.mass, link.h, {S.yy + S.zz, S.xx + S.zz, S.xx + S.yy, -S.xy, -S.xz, -S.yz}};
    out.rotor = link.rotor;
    out.stiffness = link.stiffness;
    out.rest = link.rest;
    out.load = {link.force, link.moment};
    model.link_of_dof[link.dof] = static_cast<int>(i);
    model.links.push_back(out);
  }
  return model;
}

}  // namespace dynwitness::crosscheck::kernel
