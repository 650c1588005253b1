// SPDX-License-Identifier: Apache-2.0
// A floating tree seen from another of its links. Which link a description starts from is a choice
// of its author; the motion must not depend on it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "recursive/energy.hpp"
#include "recursive/model.hpp"

namespace dynwitness::recursive {

/** The model with what rests in the world made a link that floats: link 0, with the first six rates
    and seven positions (position in the world, quaternion). Link i becomes link i + 1.
    @param body  inertia that the new link has besides that of the base */
template <typename T>
Model<T> onFloatingBase(const Model<T>& model, const RigidInertia<T>& body) {
  Model<T> out = model;
  LinkModel<T> base;
  base.dof = base.slot = 0;
  base.kind = JointKind::kFloating;
  base.M = model.base + body;
  out.base = RigidInertia<T>::zero();
  out.links.insert(out.links.begin(), base);
  for (std::size_t i = 1; i < out.links.size(); ++i) {
    LinkModel<T>& link = out.links[i];
    ++link.parent;
    if (link.dof < 0) continue;
    link.dof += 6;
    link.slot += 7;
  }
  for (int& link : out.link_of_dof) ++link;
  out.link_of_dof.insert(out.link_of_dof.begin(), 6, 0);
  for (WorldLoad<T>& load : out.world_loads) ++load.link;
  for (GearedRotor<T>& rotor : out.rotors) {
    rotor.dof += 6;
    if (rotor.carrier >= 0) ++rotor.carrier;
  }
  out.positions += 7;
  out.plain_joints = false;
  return out;
}

/// A tree seen from another link, and how its frames lie.
template <typename T>
struct Rerooted {
  Model<T> model;
  std::vector<int> link;        ///< old link -> new link
  std::vector<Transform<T>> X;  ///< old link's frame to new link's frame
  /// New links whose joint has several axes and was turned round: its coordinates are others.
  std::vector<int> turned;
};

/** A floating tree (link 0 floats, and all others hang on it) with another link as the one that
    floats.

    Each joint on the way from the old root to the new one is turned round. With X_J(q) its motion
    and X_tree its place, what was  X = X_J(q) X_tree  from parent to link must be X^-1 from the new
    parent to its new child. A joint of one axis keeps its coordinate: let F be half a turn about x:
    it reverses z, so that X_J(-q) = F X_J(q) F for a turn about z, a slide along z, and both. In
    the frame  F X_tree  (seen from the old parent's) the new child then moves by

        X_J(q) F:    the same kind of joint with the same q, rates, forces, spring, rotor and pitch

    A gyroscopic rotor stays on its link, which is now the joint's child: its axis there is y = -z,
    and with w_p = w_i + y qd (without the last where the joint slides)  h qd z.w_p  becomes  -h qd
    y.w_i - h qd^2.

    Nothing reverses three axes at once: a spherical or floating joint gets the coordinates of
    X_J^-1, with its new child in the frame X_tree; see rerootState().

    The new root has the first six rates and seven positions.
    @throws std::invalid_argument  link 0 does not float, or there is no such link */
template <typename T>
Rerooted<T> reroot(const Model<T>& model, int new_root) {
  requireOwnRates(model, "reroot");
  const int n = static_cast<int>(model.links.size());
  if (n == 0 || model.links[0].kind != JointKind::kFloating || model.links[0].dof != 0)
    throw std::invalid_argument("reroot: model: expected a floating link 0");
  if (new_root < 0 || new_root >= n)
    throw std::invalid_argument("reroot: new_root: expected 0 to " + std::to_string(n - 1) +
                                ", got " + std::to_string(new_root));
  Transform<T> F = Transform<T>::identity();
  F.R(1, 1) = F.R(2, 2) = T(-1);

  Rerooted<T> out;
  out.link.assign(n, -1);
  out.X.assign(n, Transform<T>::identity());
  std::vector<int> order;  // old links in the order of the new ones: the way first
  for (int i = new_root; i >= 0; i = model.links[i].parent) order.push_back(i);
  const auto way = static_cast<std::ptrdiff_t>(order.size());
  for (int i = 0; i < n; ++i)
    if (std::find(order.begin(), order.begin() + way, i) == order.begin() + way) order.push_back(i);
  for (int k = 0; k < n; ++k) out.link[order[k]] = k;

  Model<T>& to = out.model;
  to = model;
  for (int k = 0; k < n; ++k) {
    const int i = order[k];
    const LinkModel<T>& old = model.links[i];
    LinkModel<T> link = old;
    if (k == 0) {  // floats; its joint in the world's frame
      link = model.links[0];
      link.parent = -1;
      link.X_tree = Transform<T>::identity();
    } else if (k <
               static_cast<int>(way)) {  // the joint of the link before it on the way, turned round
      const int child = order[k - 1];
      link = model.links[child];
      link.parent = k - 1;
      link.X_tree = out.X[child].inverse();
      out.X[i] = model.links[child].X_tree;
      if (axisCount(link.kind) > 1) {
        out.turned.push_back(k);
      } else {
        link.X_tree = F * link.X_tree;
        out.X[i] = F * out.X[i];
        if (link.kind != JointKind::kPrismatic) link.rotor -= T(2) * link.spin;
        link.spin = -link.spin;
      }
    } else {
      link.parent = out.link[old.parent];
      link.X_tree = old.X_tree * out.X[old.parent].inverse();
    }
    const Transform<T> X_old = out.X[i].inverse();  // new frame to old frame
    link.M = X_old.inverseTimes(old.M);
    link.load = out.X[i] * old.load;
    to.links[k] = link;
    for (int d = 0; link.dof >= 0 && d < axisCount(link.kind); ++d)
      to.link_of_dof[link.dof + d] = k;
  }
  for (WorldLoad<T>& load : to.world_loads) {
    const Transform<T>& X = out.X[load.link];
    load.at = X.R * (load.at - X.p);
    load.link = out.link[load.link];
  }
  return out;
}

namespace detail {

/// X_J^-1 of a joint of several axes: the link's frame to the unmoved joint's.
template <typename T>
Transform<T> backThroughJoint(LinkModel<T> link, const std::vector<JointPosition<T>>& x) {
  link.X_tree = Transform<T>::identity();
  return AnyJoints::transform(link, x).inverse();
}

/// Six: Motion or Force.
template <template <typename> class Six, typename T>
void rerootJoints(const Rerooted<T>& tree, const std::vector<JointPosition<T>>& x,
                  std::vector<T>& of_joints) {
  for (const int k : tree.turned) {
    const LinkModel<T>& link = tree.model.links[k];
    const int axes = axisCount(link.kind);  // the last three, or all, of six
    T* const at = of_joints.data() + link.dof;
    Vector3<T> first = Vector3<T>::Constant(T(0)), second = first;
    for (int a = 0; a < axes; ++a) (a < axes - 3 ? first(a) : second(a - (axes - 3))) = at[a];
    const auto turned = (backThroughJoint(link, x) * Six<T>{first, second}).vector();
    for (int a = 0; a < axes; ++a) at[a] = -turned(6 - axes + a);
  }
}

}  // namespace detail

/** Rates or accelerations of a rerooted tree's joints from those of the old one, at the old
    positions x:
        V  becomes  -X_J^-1 V,  V'  becomes  -X_J^-1 V'
    for a joint turned round with several axes (the derivative of X_J^-1 adds X_J^-1 V x V = 0); the
    others keep theirs. The first six are left alone. */
template <typename T>
void rerootRates(const Rerooted<T>& tree, const std::vector<JointPosition<T>>& x,
                 std::vector<T>& rates) {
  detail::rerootJoints<Motion>(tree, x, rates);
}
/// The same for joint forces, which do the same work.
template <typename T>
void rerootForces(const Rerooted<T>& tree, const std::vector<JointPosition<T>>& x,
                  std::vector<T>& tau) {
  detail::rerootJoints<Force>(tree, x, tau);
}

/** Positions and rates of a rerooted tree in the state of the old one: the new root where it is in
    the world and with the twist that it has; a joint turned round with several axes as X_J^-1, by
    its conjugate quaternion; the others as they are.
    @param ws  of the old model; linkVelocities() writes on it */
template <typename T>
void rerootState(const Model<T>& old, const Rerooted<T>& tree, Workspace<T>& ws,
                 std::vector<JointPosition<T>>& x, std::vector<T>& qd) {
  linkVelocities(old, x, qd, ws);
  rerootRates(tree, x, qd);
  for (const int k : tree.turned) {
    const LinkModel<T>& link = tree.model.links[k];
    const Vector3<T> p = detail::backThroughJoint(link, x).p;
    int slot = link.slot;
    if (link.kind == JointKind::kFloating)
      for (int axis = 0; axis < 3; ++axis) x[slot++].q = p(axis);
    for (int i = 1; i < 4; ++i) x[slot + i].q = -x[slot + i].q;
  }
  int root = 0;
  while (tree.link[root] != 0) ++root;
  Transform<T> X = Transform<T>::identity();  // world to root
  for (int i = root; i >= 0; i = old.links[i].parent) X = X * ws.X_up[i];
  const Matrix3<T> R = X.R.transpose();
  // the quaternion of R, of length 2 sqrt(1 + tr R): nothing needs it to be 1
  const T q[] = {T(1) + R.trace(), R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)};
  for (int k = 0; k < 3; ++k) x[k].q = X.p(k);
  for (int k = 0; k < 4; ++k) x[3 + k].q = q[k];
  for (int k = 0; k < 3; ++k) {
    qd[k] = ws.v[root].linear(k);
    qd[3 + k] = ws.v[root].angular(k);
  }
}

}  // namespace dynwitness::recursive
