// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of reactions: what joints transmit is what motion, weight and loads ask for.
#pragma once

#include <algorithm>
#include <vector>

#include "crosscheck/laws/swept_mechanism.hpp"

namespace dynwitness::crosscheck {

/// The link of a model with fixed joints that the parent of scene link i is; -1: the world.
template <typename T>
int inboardLink(const recursive::Model<T>& model, std::size_t i) {
  int j = model.joints[i].link;
  // the links of a chain belong to one joint: those that no scene link is carried by
  do j = model.links[j].parent;
  while (j >= 0 && std::none_of(model.joints.begin(), model.joints.end(),
                                [j](const auto& joint) { return joint.link == j; }));
  return j;
}

struct ReactionsAlongAxes : Law {
  static constexpr LawWords kWords = {
      "reactions along joint axes", "Z'f = M qdd + C qd + dV/dq - Q - (what rotor and spring take)",
      "tau", "newton_euler", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const recursive::Model<T>& model = at.withFixedJoints();
    const recursive::Workspace<T>& swept = at.sweptWithFixedJoints();
    const scene::State<T>& state = at.state();
    recursive::Terms only_loads = recursive::Terms::none();
    only_loads.loads = true;
    const recursive::MatrixX<T> minus_Q = at.inverse(at.zeros(), at.zeros(), only_loads);
    TwoSides<T> sides = {recursive::MatrixX<T>::Constant(at.n(), 1, T(0)),
                         at.M() * at.qdd() + at.C() * at.qd() + at.potentialGradient() + minus_Q};
    for (std::size_t i = 1; i < model.joints.size(); ++i) {
      // a chain of parts: the wrench passes through all of them
      const recursive::ScenePlace<T>& joint = model.joints[i];
      recursive::Force<T> through = joint.X.inverseTimes(at.reactions()[i]);
      for (int j = joint.link, end = inboardLink(model, i); j != end; j = model.links[j].parent) {
        const recursive::LinkModel<T>& part = model.links[j];
        for (int k = 0; k < recursive::axisCount(part.kind); ++k)
          sides.left(part.dof + k, 0) += recursive::AnyJoints::force(part, k, through);
        if (part.dof >= 0) {
          T taken = part.rotor * state.qdd[part.dof] +
                    part.stiffness * (state.x[part.slot + part.spring_from].q - part.rest);
          if (part.parent >= 0)
            taken += dot(swept.X_up[j] * swept.a[part.parent], recursive::spinAxis(part));
          sides.right(part.dof, 0) -= taken;
        }
        through = swept.X_up[j].inverseTimes(through);
      }
    }
    for (const recursive::GearedRotor<T>& rotor : model.rotors) {
      T moment = rotor.inertia * recursive::rotorRate(rotor, state.qdd);
      if (rotor.carrier >= 0) moment += dot(swept.a[rotor.carrier], recursive::spinAxis(rotor));
      for (std::size_t k = 0; k < rotor.ratio.size(); ++k)
        sides.right(rotor.dof + static_cast<int>(k), 0) -= rotor.ratio[k] * moment;
    }
    return sides;
  }
};

/// Six numbers in world axes about the world's origin.
struct ReactionsAtTheBase : Law {
  static constexpr LawWords kWords = {"reactions at the base",
                                      "sum of f = d(momentum)/dt - weight - loads", "reactions",
                                      "newton_euler", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const recursive::Model<T>& model = at.withFixedJoints();
    const recursive::Workspace<T>& swept = at.sweptWithFixedJoints();
    recursive::Force<T> sum = recursive::Force<T>::zero();
    for (std::size_t i = 1; i < model.joints.size(); ++i) {
      if (inboardLink(model, i) >= 0) continue;
      recursive::Force<T> at_world = model.joints[i].X.inverseTimes(at.reactions()[i]);
      for (int j = model.joints[i].link; j >= 0; j = model.links[j].parent)
        at_world = swept.X_up[j].inverseTimes(at_world);
      sum = sum + at_world;
    }
    // weight and loads: link by link, where they are
    recursive::Force<T> applied = recursive::Force<T>::zero();
    std::vector<recursive::Transform<T>> X_W;  // world to link
    for (std::size_t i = 0; i < model.links.size(); ++i) {
      const recursive::LinkModel<T>& link = model.links[i];
      X_W.push_back(link.parent < 0 ? swept.X_up[i] : swept.X_up[i] * X_W[link.parent]);
      const recursive::RigidInertia<T> M = X_W.back().inverseTimes(link.M);
      applied = applied + recursive::Force<T>{model.gravity * M.mass, M.h.cross(model.gravity)} +
                X_W.back().inverseTimes(link.load);
    }
    for (const recursive::WorldLoad<T>& load : model.world_loads) {
      const recursive::Transform<T>& X = X_W[load.link];
      const recursive::Vector3<T> on = X.p + X.R.transpose() * load.at;
      applied = applied + recursive::Force<T>{load.force, load.moment + on.cross(load.force)};
    }
    return {sum.vector(), at.momentumRate() - recursive::MatrixX<T>(applied.vector())};
  }
};

}  // namespace dynwitness::crosscheck
