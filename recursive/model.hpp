// SPDX-License-Identifier: Apache-2.0
// A mechanism as the sweeps read it: flat, in topological order, every joint axis along z.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "recursive/spatial.hpp"
#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::recursive {

using scene::CosSin;
using scene::JointKind;
using scene::JointPosition;

/** One link. Its frame is the moved joint frame, turned so that the joint moves about or along z;
    mass properties, loads and the joints of its children are given there. */
template <typename T>
struct LinkModel {
  int parent = -1;  ///< -1: the world
  int dof = -1;     ///< index into q; -1: fixed
  JointKind kind = JointKind::kFixed;
  Transform<T> X_tree = Transform<T>::identity();  ///< parent link frame to unmoved joint frame
  RigidInertia<T> M = RigidInertia<T>::zero();
  T rotor = T(0);                                ///< d = gear_ratio^2 rotor_inertia [kg m^2], [kg]
  T stiffness = T(0), rest = T(0);               ///< [N m/rad], [rad] or [N/m], [m]
  Force<T> load = Force<T>::zero();  ///< constant wrench in link axes, about the origin [N, N m]
};

/// A force and a free moment in world axes [N, N m], the force acting at this point of the link [m].
template <typename T>
struct WorldLoad {
  int link;
  Vector3<T> force, moment, at;
};

/// Where a link of the scene is found in the model, which lumps fixed joints and turns frames.
template <typename T>
struct ScenePlace {
  int link;        ///< of the model; -1: the world
  Transform<T> X;  ///< that link's frame to the scene's link frame
};

template <typename T>
struct Model {
  std::vector<LinkModel<T>> links;
  std::vector<ScenePlace<T>> places;  ///< one a link of the scene
  std::vector<int> link_of_dof;
  /// What rests in the world: it enters the potential energy only.
  RigidInertia<T> base = RigidInertia<T>::zero();
  Vector3<T> gravity = Vector3<T>::Zero();  ///< [m/s^2], world axes
  std::vector<WorldLoad<T>> world_loads;    ///< if any, sweeps carry the links' orientation

  int dof() const { return static_cast<int>(link_of_dof.size()); }
};

/// Which terms a sweep includes besides M qdd and the velocity products.
struct Terms {
  bool gravity = true, springs = true, loads = true;
  static constexpr Terms all() { return {}; }
  static constexpr Terms none() { return {false, false, false}; }
  static constexpr Terms potential() { return {true, true, false}; }
};

/// A caller's vector must have one entry a degree of freedom.
/// @throws std::invalid_argument  "inverseDynamics: qd: expected 3 joint values, got 2"
template <typename T>
void requireSize(const Model<T>& model, const char* function, const char* argument, std::size_t size) {
  if (static_cast<int>(size) != model.dof())
    throw std::invalid_argument(std::string(function) + ": " + argument + ": expected " +
                                std::to_string(model.dof()) + " joint values, got " +
                                std::to_string(size));
}

/// What the sweeps write on: sized once for a model, then reused without allocation.
template <typename T>
struct Workspace {
  explicit Workspace(const Model<T>& model)
      : X_up(model.links.size(), Transform<T>::identity()),
        R_W(model.links.size(), Matrix3<T>::Identity()),
        v(model.links.size(), Motion<T>::zero()),
        a(v),
        c(v),
        f(model.links.size(), Force<T>::zero()),
        U(f),
        I_C(model.links.size(), RigidInertia<T>::zero()),
        M_A(model.links.size(), ArticulatedInertia<T>::zero()),
        D(model.links.size(), T(0)),
        u(D) {}

  std::vector<Transform<T>> X_up;  ///< parent to link
  std::vector<Matrix3<T>> R_W;     ///< world axes to link axes
  std::vector<Motion<T>> v, a, c;  ///< velocity, acceleration, velocity-product acceleration
  std::vector<Force<T>> f, U;      ///< force through the joint (or bias force); M_A Z
  std::vector<RigidInertia<T>> I_C;         ///< composite inertia
  std::vector<ArticulatedInertia<T>> M_A;   ///< articulated inertia
  std::vector<T> D, u;             ///< d + Z' M_A Z; joint force left for acceleration
};

/// X_J X_tree: parent link frame to link frame at joint position x.
template <typename T>
Transform<T> linkTransform(const LinkModel<T>& link, const std::vector<JointPosition<T>>& x) {
  Transform<T> X = link.X_tree;
  switch (link.kind) {
    case JointKind::kRevolute: {
      const T &c = x[link.dof].c, &s = x[link.dof].s;
      X.R.row(0) = link.X_tree.R.row(0) * c + link.X_tree.R.row(1) * s;
      X.R.row(1) = link.X_tree.R.row(1) * c - link.X_tree.R.row(0) * s;
      break;
    }
    case JointKind::kPrismatic:
      X.p += link.X_tree.R.row(2).transpose() * x[link.dof].q;
      break;
    case JointKind::kFixed: break;
  }
  return X;
}

/// Z rate: the motion through the joint at this rate (or acceleration), in link coordinates.
template <typename T>
Motion<T> jointMotion(const LinkModel<T>& link, const std::vector<T>& rates) {
  Motion<T> x = Motion<T>::zero();
  if (link.kind == JointKind::kRevolute) x.angular.z() = rates[link.dof];
  if (link.kind == JointKind::kPrismatic) x.linear.z() = rates[link.dof];
  return x;
}

/// Z' F: the component of a force that works on the joint's motion.
template <typename T>
const T& jointForce(const LinkModel<T>& link, const Force<T>& f) {
  return link.kind == JointKind::kPrismatic ? f.force.z() : f.moment.z();
}

/// M Z: the column of an inertia that belongs to the joint's motion.
template <typename T>
Force<T> jointColumn(const LinkModel<T>& link, const ArticulatedInertia<T>& M) {
  if (link.kind == JointKind::kPrismatic) return {M.A.columnZ(), M.B.row(2).transpose()};
  return {M.B.col(2), M.C.columnZ()};
}
template <typename T>
Force<T> jointColumn(const LinkModel<T>& link, const RigidInertia<T>& M) {
  if (link.kind == JointKind::kPrismatic)
    return {{T(0), T(0), M.mass}, {M.h.y(), -M.h.x(), T(0)}};
  return {{-M.h.y(), M.h.x(), T(0)}, M.I.columnZ()};
}

/// Takes the scene's loads off the forces f that the links need, link by link.
/// ws.X_up must be set; ws.R_W is set when a load in world axes asks for it.
template <typename T>
void subtractLoads(const Model<T>& model, Workspace<T>& ws, std::vector<Force<T>>& f) {
  for (std::size_t i = 0; i < model.links.size(); ++i) f[i] = f[i] - model.links[i].load;
  if (model.world_loads.empty()) return;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const int p = model.links[i].parent;
    ws.R_W[i] = p < 0 ? ws.X_up[i].R : Matrix3<T>(ws.X_up[i].R * ws.R_W[p]);
  }
  for (const WorldLoad<T>& load : model.world_loads) {
    const Matrix3<T>& R = ws.R_W[load.link];
    const Vector3<T> force = R * load.force;
    f[load.link] = f[load.link] - Force<T>{force, R * load.moment + load.at.cross(force)};
  }
}

}  // namespace dynwitness::recursive
