// SPDX-License-Identifier: GPL-3.0-or-later
// A model for duals: what it takes to differentiate a sweep.
#pragma once

#include <vector>

#include "crosscheck/scalars/dual.hpp"
#include "recursive/model.hpp"

namespace dynwitness::crosscheck {

/// The same model in a scalar S made from T (duals, nested duals): its numbers are constants.
template <typename S, typename T>
recursive::Model<S> lifted(const recursive::Model<T>& model) {
  using recursive::Vector3;
  const auto vector = [](const Vector3<T>& v) { return Vector3<S>(S(v.x()), S(v.y()), S(v.z())); };
  const auto inertia = [&](const recursive::RigidInertia<T>& M) {
    const recursive::Symmetric3<T>& I = M.I;
    return recursive::RigidInertia<S>{
        S(M.mass), vector(M.h), {S(I.xx), S(I.yy), S(I.zz), S(I.xy), S(I.xz), S(I.yz)}};
  };
  recursive::Model<S> out;
  out.gravity = vector(model.gravity);
  out.link_of_dof = model.link_of_dof;
  out.positions = model.positions;
  out.plain_joints = model.plain_joints;
  out.gyroscopic = model.gyroscopic;
  out.friction = model.friction;
  out.coupled = model.coupled;
  out.base = inertia(model.base);
  for (const recursive::LinkModel<T>& link : model.links) {
    recursive::LinkModel<S> l;
    l.parent = link.parent;
    l.dof = link.dof;
    l.slot = link.slot;
    l.spring_from = link.spring_from;
    l.follows = link.follows;
    l.adds = link.adds;
    l.ratio = S(link.ratio);
    l.kind = link.kind;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) l.X_tree.R(i, j) = S(link.X_tree.R(i, j));
    l.X_tree.p = vector(link.X_tree.p);
    l.M = inertia(link.M);
    l.rotor = S(link.rotor);
    l.spin = S(link.spin);
    l.viscous = S(link.viscous);
    l.positive = S(link.positive);
    l.negative = S(link.negative);
    l.stiffness = S(link.stiffness);
    l.rest = S(link.rest);
    l.pitch = S(link.pitch);
    l.load = {vector(link.load.force), vector(link.load.moment)};
    out.links.push_back(l);
  }
  for (const recursive::GearedRotor<T>& rotor : model.rotors) {
    recursive::GearedRotor<S> r{rotor.dof, {}, S(rotor.inertia), rotor.carrier, vector(rotor.axis)};
    for (const T& n : rotor.ratio) r.ratio.push_back(S(n));
    out.rotors.push_back(r);
  }
  for (const recursive::WorldLoad<T>& load : model.world_loads)
    out.world_loads.push_back(
        {load.link, vector(load.force), vector(load.moment), vector(load.at)});
  return out;
}

}  // namespace dynwitness::crosscheck
