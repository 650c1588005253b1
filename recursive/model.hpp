// SPDX-License-Identifier: Apache-2.0
// A mechanism as the sweeps read it: flat, in topological order, every joint's axes constant unit
// vectors of its link.
#pragma once

#include <array>
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

/** One link. Its frame is the moved joint frame, turned so that a joint with one axis moves about
    or along z; mass properties, loads and the joints of its children are given there.

    A joint's axes Z_k are columns of the motion that it passes on, v_J = sum of Z_k qd_k, constant
    in the link's frame: e_z to turn about or to slide along, both for a screw; the three turns of a
    spherical joint; the three slides and three turns of a floating one. Cylindrical, universal and
    planar joints are chains of links with one axis each, massless but for the last (buildModel).

    A follower (scene::Mimic) moves with its leader's rate: its axis is k Z, k the ratio of the
    rates, and what else goes with a rate is written in the leader's: k^2 d, k h, k^2 viscous, |k|
    Coulomb (of the other direction where k < 0), and the spring as one of k^2 stiffness on the
    leader's position. So the sweeps' formulas stay what they are; only entries of a rate are sums
    over its joints. */
template <typename T>
struct LinkModel {
  int parent = -1;       ///< -1: the world
  int dof = -1;          ///< index of the joint's first rate in qd; -1: fixed
  int slot = -1;         ///< index of the joint's first position in q
  int spring_from = 0;   ///< slots to the position that its spring measures: to a follower's leader
  bool follows = false;  ///< with `ratio`
  bool adds = false;     ///< a link further outboard in the list has the same rate
  T ratio = T(1);        ///< of its rate to the leader's
  JointKind kind = JointKind::kFixed;
  Transform<T> X_tree = Transform<T>::identity();  ///< parent link frame to unmoved joint frame
  RigidInertia<T> M = RigidInertia<T>::zero();
  T rotor = T(0);  ///< d = gear_ratio^2 rotor_inertia [kg m^2], [kg]
  T spin = T(0);   ///< h = gear_ratio rotor_inertia of a gyroscopic rotor, which the parent carries
  T viscous = T(0), positive = T(0), negative = T(0);  ///< friction (scene::Friction)
  T stiffness = T(0), rest = T(0);                     ///< [N m/rad], [rad] or [N/m], [m]
  T pitch = T(0);                                      ///< of a screw [m/rad]
  Force<T> load = Force<T>::zero();  ///< constant wrench in link axes, about the origin [N, N m]
};

/** A rotor that is geared to all rates of a joint (scene::Rotor), which turns at  psi' = sum of
    ratio_k nu_k.  A gyroscopic one spins about an axis of the link that carries it, which feels it
    and includes it as it stands. */
template <typename T>
struct GearedRotor {
  int dof;               ///< the joint's first rate
  std::vector<T> ratio;  ///< one a rate of the joint
  T inertia;             ///< J [kg m^2]
  int carrier;           ///< link; -1: nobody feels its spin
  Vector3<T> axis;       ///< of length 1, in the carrier's axes
};

/// A force and a free moment in world axes [N, N m], the force acting at this point of the link
/// [m].
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
  /// One a link of the scene: the link of the model that its joint moves, and that link's frame to
  /// the moved joint frame. -1: no joint of the model (the root; a fixed joint that was lumped).
  std::vector<ScenePlace<T>> joints;
  std::vector<int> link_of_dof;
  std::vector<GearedRotor<T>> rotors;
  int positions = 0;                          ///< how many slots q has: dof(), and one a quaternion
  bool plain_joints = true;                   ///< all are fixed, revolute or prismatic
  bool gyroscopic = false, friction = false;  ///< any of spin, any friction
  bool coupled = false;                       ///< some joints follow others, or there are `rotors`
  /// What rests in the world: it enters the potential energy only.
  RigidInertia<T> base = RigidInertia<T>::zero();
  Vector3<T> gravity = Vector3<T>::Zero();  ///< [m/s^2], world axes
  std::vector<WorldLoad<T>> world_loads;    ///< if any, sweeps carry the links' orientation

  int dof() const { return static_cast<int>(link_of_dof.size()); }
};

/// Which terms a sweep includes besides M qdd and the velocity products.
struct Terms {
  bool gravity = true, springs = true, loads = true, friction = true;
  static constexpr Terms all() { return {}; }
  static constexpr Terms none() { return {false, false, false, false}; }
  static constexpr Terms potential() { return {true, true, false, false}; }
};

/// A caller's vector must have one entry a degree of freedom.
/// @throws std::invalid_argument  "inverseDynamics: qd: expected 3 joint values, got 2"
template <typename T>
void requireSize(const Model<T>& model, const char* function, const char* argument,
                 std::size_t size) {
  if (static_cast<int>(size) != model.dof())
    throw std::invalid_argument(std::string(function) + ": " + argument + ": expected " +
                                std::to_string(model.dof()) + " joint values, got " +
                                std::to_string(size));
}
/// The same for a caller's positions, one a slot.
template <typename T>
void requirePositions(const Model<T>& model, const char* function, std::size_t size) {
  if (static_cast<int>(size) != model.positions)
    throw std::invalid_argument(std::string(function) + ": x: expected " +
                                std::to_string(model.positions) + " joint values, got " +
                                std::to_string(size));
}

/// For sweeps that solve for each joint where they pass it.
/// @throws std::invalid_argument  joints follow others
template <typename T>
void requireOwnRates(const Model<T>& model, const char* function) {
  if (model.coupled)
    throw std::invalid_argument(std::string(function) +
                                ": model: joints follow others (mimic) or have rotors geared to "
                                "several rates, expected joints with rates of their own");
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
        U(model.link_of_dof.size(), Force<T>::zero()),
        I_C(model.links.size(), RigidInertia<T>::zero()),
        M_A(model.links.size(), ArticulatedInertia<T>::zero()),
        D(model.link_of_dof.size(), T(0)),
        u(D) {}

  std::vector<Transform<T>> X_up;    ///< parent to link
  std::vector<Matrix3<T>> R_W;       ///< world axes to link axes
  std::vector<Motion<T>> v, a, c;    ///< velocity, acceleration, velocity-product acceleration
  std::vector<Force<T>> f;           ///< force through the joint (or bias force)
  std::vector<Force<T>> U;           ///< one a degree of freedom: M_A Z,
  std::vector<RigidInertia<T>> I_C;  ///< composite inertia
  std::vector<ArticulatedInertia<T>> M_A;  ///< articulated inertia
  std::vector<T> D, u;                     ///< and d + Z' M_A Z; joint force left for acceleration
};

/// How many axes a joint of the model has.
inline int axisCount(JointKind kind) {
  static constexpr int kAxes[] = {0, 1, 1, 1, 1, 1, 1, 3, 6};
  return kAxes[static_cast<int>(kind)];
}

/// R_JL, link axes to axes of the unmoved joint frame, of the quaternion that starts at x:
///     R = 1 + 2 (w [v]x + [v]x [v]x) / (q'q)
template <typename T>
Matrix3<T> rotation(const JointPosition<T>* x) {
  const std::array<T, 4> q = scene::quaternionAt(x);
  const Vector3<T> v(q[1], q[2], q[3]);
  const T& w = q[0];
  const T scale = T(2) / (w * w + v.dot(v));
  const Matrix3<T> v_hat = skew<T>(v);
  return Matrix3<T>::Identity() + (v_hat * w + v_hat * v_hat) * scale;
}

/** What joints do to motions, forces and inertias, for every kind: with Z_k their axes (LinkModel),

        transform   X_J X_tree: parent link frame to link frame at joint position x
        motion     sum of Z_k rate_k: the motion through the joint at these rates (or accelerations)
        addMotion   x += Z_k rate
        force       Z_k' F: the component of a force that works on the joint's motion
        column      M Z_k: the column of an inertia, rigid or articulated
    all in link coordinates. */
struct AnyJoints {
  static constexpr bool kMayFollow = true;

  template <typename T>
  static int axes(const LinkModel<T>& link) {
    return axisCount(link.kind);
  }

  template <typename T>
  static Transform<T> transform(const LinkModel<T>& link, const std::vector<JointPosition<T>>& x) {
    Transform<T> X = link.X_tree;
    int slot = link.slot;
    if (link.kind == JointKind::kFloating) {
      X.p += link.X_tree.R.transpose() * Vector3<T>(x[slot].q, x[slot + 1].q, x[slot + 2].q);
      slot += 3;
    }
    if (axes(link) >= 3) X.R = rotation(&x[slot]).transpose() * link.X_tree.R;
    if (link.kind == JointKind::kPrismatic) X.p += link.X_tree.R.row(2).transpose() * x[slot].q;
    if (link.kind == JointKind::kHelical)
      X.p += link.X_tree.R.row(2).transpose() * (link.pitch * x[slot].q);
    if (link.kind == JointKind::kRevolute || link.kind == JointKind::kHelical) {
      const T &c = x[slot].c, &s = x[slot].s;
      X.R.row(0) = link.X_tree.R.row(0) * c + link.X_tree.R.row(1) * s;
      X.R.row(1) = link.X_tree.R.row(1) * c - link.X_tree.R.row(0) * s;
    }
    return X;
  }

  template <typename T>
  static void addMotion(const LinkModel<T>& link, int k, const T& rate, Motion<T>& x) {
    if (link.follows)
      addOwnMotion(link, k, T(link.ratio * rate), x);
    else
      addOwnMotion(link, k, rate, x);
  }
  template <typename T>
  static Motion<T> motion(const LinkModel<T>& link, const std::vector<T>& rates) {
    Motion<T> x = Motion<T>::zero();
    for (int k = 0; k < axes(link); ++k) addMotion(link, k, rates[link.dof + k], x);
    return x;
  }
  template <typename T>
  static T force(const LinkModel<T>& link, int k, const Force<T>& f) {
    if (link.follows) return link.ratio * ownForce(link, k, f);
    return ownForce(link, k, f);
  }
  template <typename T, typename Inertia>
  static Force<T> column(const LinkModel<T>& link, int k, const Inertia& M) {
    if (link.follows) return ownColumn(link, k, M) * link.ratio;
    return ownColumn(link, k, M);
  }

 private:  // of the joint's own rate
  template <typename T>
  static void addOwnMotion(const LinkModel<T>& link, int k, const T& rate, Motion<T>& x) {
    switch (link.kind) {
      case JointKind::kHelical:
        x.linear.z() += link.pitch * rate;
        [[fallthrough]];
      case JointKind::kRevolute:
        x.angular.z() += rate;
        break;
      case JointKind::kPrismatic:
        x.linear.z() += rate;
        break;
      case JointKind::kSpherical:
        x.angular(k) += rate;
        break;
      case JointKind::kFloating:
        (k < 3 ? x.linear(k) : x.angular(k - 3)) += rate;
        break;
      default:
        break;  // fixed; what buildModel makes chains of does not occur
    }
  }
  template <typename T>
  static T ownForce(const LinkModel<T>& link, int k, const Force<T>& f) {
    switch (link.kind) {
      case JointKind::kPrismatic:
        return f.force.z();
      case JointKind::kHelical:
        return f.moment.z() + link.pitch * f.force.z();
      case JointKind::kSpherical:
        return f.moment(k);
      case JointKind::kFloating:
        return k < 3 ? f.force(k) : f.moment(k - 3);
      default:
        return f.moment.z();
    }
  }

  template <typename T, typename Inertia>
  static Force<T> ownColumn(const LinkModel<T>& link, int k, const Inertia& M) {
    switch (link.kind) {
      case JointKind::kPrismatic:
        return M.linearColumn(2);
      case JointKind::kHelical:
        return M.angularColumn(2) + M.linearColumn(2) * link.pitch;
      case JointKind::kSpherical:
        return M.angularColumn(k);
      case JointKind::kFloating:
        return k < 3 ? M.linearColumn(k) : M.angularColumn(k - 3);
      default:
        return M.angularColumn(2);
    }
  }
};

/** The same where all joints are fixed, revolute or prismatic. The sweeps are compiled for either,
    so that most mechanisms pay nothing for the kinds that they do not have (with AnyJoints alone,
    sweeps of a 7R arm took 8 to 25 % more instructions). */
struct PlainJoints {
  static constexpr bool kMayFollow = false;

  template <typename T>
  static int axes(const LinkModel<T>& link) {
    return link.dof >= 0 ? 1 : 0;
  }
  template <typename T>
  static Transform<T> transform(const LinkModel<T>& link, const std::vector<JointPosition<T>>& x) {
    Transform<T> X = link.X_tree;
    switch (link.kind) {
      case JointKind::kRevolute: {
        const T &c = x[link.slot].c, &s = x[link.slot].s;
        X.R.row(0) = link.X_tree.R.row(0) * c + link.X_tree.R.row(1) * s;
        X.R.row(1) = link.X_tree.R.row(1) * c - link.X_tree.R.row(0) * s;
        break;
      }
      case JointKind::kPrismatic:
        X.p += link.X_tree.R.row(2).transpose() * x[link.slot].q;
        break;
      default:
        break;
    }
    return X;
  }
  template <typename T>
  static void addMotion(const LinkModel<T>& link, int, const T& rate, Motion<T>& x) {
    (link.kind == JointKind::kPrismatic ? x.linear.z() : x.angular.z()) += rate;
  }
  template <typename T>
  static Motion<T> motion(const LinkModel<T>& link, const std::vector<T>& rates) {
    Motion<T> x = Motion<T>::zero();
    if (link.kind == JointKind::kRevolute) x.angular.z() = rates[link.dof];
    if (link.kind == JointKind::kPrismatic) x.linear.z() = rates[link.dof];
    return x;
  }
  template <typename T>
  static const T& force(const LinkModel<T>& link, int, const Force<T>& f) {
    return link.kind == JointKind::kPrismatic ? f.force.z() : f.moment.z();
  }
  template <typename T, typename Inertia>
  static Force<T> column(const LinkModel<T>& link, int, const Inertia& M) {
    return link.kind == JointKind::kPrismatic ? M.linearColumn(2) : M.angularColumn(2);
  }
};

/// Calls sweep(joints) with the joints that the model has.
template <typename T, typename Sweep>
void withJoints(const Model<T>& model, const Sweep& sweep) {
  if (model.plain_joints)
    sweep(PlainJoints());
  else
    sweep(AnyJoints());
}

/// Z_k as six numbers.
template <typename T>
Vector6<T> jointAxis(const LinkModel<T>& link, int k) {
  Motion<T> Z = Motion<T>::zero();
  AnyJoints::addMotion(link, k, T(1), Z);
  return Z.vector();
}

}  // namespace dynwitness::recursive
