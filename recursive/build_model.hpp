// SPDX-License-Identifier: Apache-2.0
// From a scene's mechanism to the flat model that the sweeps read.
#pragma once

#include "recursive/model.hpp"
#include "scene/mimic.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::recursive {

/// Links on fixed joints become part of the link that carries them, or stay links of their own.
enum class FixedJoints { kLumped, kKept };

namespace detail {

template <typename T>
Matrix3<T> aboutX(const CosSin<T>& a) {
  return (Matrix3<T>() << T(1), T(0), T(0), T(0), a.c, -a.s, T(0), a.s, a.c).finished();
}
template <typename T>
Matrix3<T> aboutY(const CosSin<T>& a) {
  return (Matrix3<T>() << a.c, T(0), a.s, T(0), T(1), T(0), -a.s, T(0), a.c).finished();
}
template <typename T>
Matrix3<T> aboutZ(const CosSin<T>& a) {
  return (Matrix3<T>() << a.c, -a.s, T(0), a.s, a.c, T(0), T(0), T(0), T(1)).finished();
}

template <typename T, typename Numbers>
Vector3<T> vector(const scene::Vector& v, const Numbers& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

/// The transformation from the frame before a sequence of steps to the frame after it.
template <typename T, typename Numbers>
Transform<T> composed(const std::vector<scene::Step>& steps, const Numbers& number) {
  using Kind = scene::Step::Kind;
  Transform<T> X = Transform<T>::identity();
  for (const scene::Step& step : steps) {
    Transform<T> X_step = Transform<T>::identity();
    switch (step.kind) {
      case Kind::kTranslate:
        X_step.p = vector<T>(step.translation, number);
        break;
      // a frame turned by R sees coordinates turned by R'
      case Kind::kRotateX:
        X_step.R = aboutX<T>(number.angle(step.angle)).transpose();
        break;
      case Kind::kRotateY:
        X_step.R = aboutY<T>(number.angle(step.angle)).transpose();
        break;
      case Kind::kRotateZ:
        X_step.R = aboutZ<T>(number.angle(step.angle)).transpose();
        break;
    }
    X = X_step * X;
  }
  return X;
}

/// One axis of a joint, or its axes where the sweeps pass them together.
struct JointPart {
  JointKind kind;
  int axis;   ///< of the joint frame, 0, 1, 2: what becomes z of the part's frame
  int slots;  ///< how many positions it has
};

/** What a joint is made of. Cylindrical, universal and planar joints are chains of parts: their
    motion is the product of the motions of one axis each, so that a chain is the joint exactly. */
inline std::vector<JointPart> partsOf(JointKind kind) {
  constexpr JointKind turn = JointKind::kRevolute, slide = JointKind::kPrismatic;
  switch (kind) {
    case JointKind::kCylindrical:
      return {{slide, 2, 1}, {turn, 2, 1}};
    case JointKind::kUniversal:
      return {{turn, 0, 1}, {turn, 1, 1}};
    case JointKind::kPlanar:
      return {{slide, 0, 1}, {slide, 1, 1}, {turn, 2, 1}};
    default:
      return {{kind, 2, static_cast<int>(scene::positionSlots(kind).size())}};
  }
}

/// Turns coordinate axes in a circle so that this one comes to stand as z.
template <typename T>
Transform<T> asZ(int axis) {
  Transform<T> X{Matrix3<T>::Constant(T(0)), Vector3<T>::Constant(T(0))};
  for (int k = 0; k < 3; ++k) X.R(k, (axis + 1 + k) % 3) = T(1);
  return X;
}

/// Rigid inertia in the scene's link frame.
template <typename T, typename Numbers>
RigidInertia<T> rigidInertia(const scene::MassProperties& m, const Numbers& number) {
  const T mass = number(m.mass);
  const Vector3<T> r_c = vector<T>(m.com, number);
  const Matrix3<T> R = aboutZ<T>(number.angle(m.rpy[2])) * aboutY<T>(number.angle(m.rpy[1])) *
                       aboutX<T>(number.angle(m.rpy[0]));
  const Symmetric3<T> I = Symmetric3<T>{number(m.xx), number(m.yy), number(m.zz),
                                        number(m.xy), number(m.xz), number(m.yz)}
                              .turnedBack(R.transpose());
  if (m.about == scene::MassProperties::About::kCenterOfMass)
    return RigidInertia<T>::aboutCenterOfMass(mass, r_c, I);
  return {mass, r_c * mass, I};
}

/// Writes what goes with a follower's rate in its leader's (LinkModel).
template <typename T, typename Numbers>
void follow(const scene::Follower& follower, const Numbers& number, LinkModel<T>& link) {
  const T k = number(scene::Number(follower.multiplier));
  const bool forward = follower.multiplier > 0;
  const T size = forward ? k : -k, positive = link.positive, negative = link.negative;
  link.follows = true;
  link.ratio = k;
  link.dof = follower.rate;
  link.spring_from = follower.leader_slot - follower.slot;
  link.rotor = k * k * link.rotor;
  link.spin = k * link.spin;
  link.viscous = k * k * link.viscous;
  link.positive = size * (forward ? positive : negative);
  link.negative = size * (forward ? negative : positive);
  // stiffness (k q + offset - rest)^2 = k^2 stiffness (q - (rest - offset) / k)^2
  link.stiffness = k * k * link.stiffness;
  link.rest = (link.rest - number(follower.offset)) / k;
}

/// The rotors of a joint geared to several rates. @param X_joint  the carrier's frame to that of
/// the joint
template <typename Numbers, typename T>
void addRotors(const scene::Joint& joint, int dof, int carrier, const Transform<T>& X_joint,
               const Numbers& number, Model<T>& model) {
  for (const scene::Rotor& rotor : joint.rotors) {
    GearedRotor<T> out{dof, {}, number(rotor.inertia), -1, Vector3<T>::Constant(T(0))};
    for (const scene::Number& n : rotor.ratio) out.ratio.push_back(number(n));
    if (rotor.axis && carrier >= 0) {
      const scene::AxisTurn<T> turn = number.axisTurn(*rotor.axis);
      out.carrier = carrier;
      out.axis = X_joint.R.transpose() * (aboutZ<T>(turn.alpha) * aboutY<T>(turn.beta)).col(2);
    }
    model.rotors.push_back(out);
  }
}

}  // namespace detail

/** Builds the model of a mechanism, its cylindrical, universal and planar joints as chains of
    massless links, for the scalar of `number` (the "Numbers" concept of scene/numbers.hpp), all in
    that scalar's own arithmetic. */
template <typename Numbers, typename T = typename Numbers::Scalar>
Model<T> buildModel(const scene::Mechanism& mechanism, const Numbers& number,
                    FixedJoints fixed_joints = FixedJoints::kLumped) {
  Model<T> model;
  if (mechanism.has_gravity) model.gravity = detail::vector<T>(mechanism.gravity, number);

  // scene link -> model link that carries it (-1: the world), and carrier frame -> scene link frame
  std::vector<int> carrier(mechanism.links.size(), -1);
  std::vector<Transform<T>> X_carrier(mechanism.links.size(), Transform<T>::identity());

  const std::vector<scene::Follower> followers = scene::followers(mechanism);
  auto follower = followers.begin();
  model.coupled = !followers.empty();

  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const scene::Link& link = mechanism.links[i];
    const bool is_root = link.parent < 0;
    const Transform<T> X_parent = is_root ? Transform<T>::identity() : X_carrier[link.parent];
    const int parent = is_root ? -1 : carrier[link.parent];
    const Transform<T> X_before =
        detail::composed<T>(link.joint.placement.beforeJoint(), number) * X_parent;
    const Transform<T> X_after = detail::composed<T>(link.joint.placement.afterJoint(), number);
    const bool lumped =
        is_root || (link.joint.kind == JointKind::kFixed && fixed_joints == FixedJoints::kLumped);
    if (lumped) {
      carrier[i] = parent;
      X_carrier[i] = X_after * X_before;
      model.joints.push_back({-1, Transform<T>::identity()});
    } else {
      // the model's frame has z along the axis: joint axes turned by Rz(alpha) Ry(beta)
      const scene::AxisTurn<T> turn = number.axisTurn(link.joint.axis);
      Transform<T> X_z = Transform<T>::identity();
      X_z.R = (detail::aboutZ<T>(turn.alpha) * detail::aboutY<T>(turn.beta)).transpose();
      Transform<T> X_tree = X_z * X_before;  // to the axes that the next part finds
      Transform<T> X_back = X_z.inverse();   // from the last part's frame to joint axes
      carrier[i] = parent;
      detail::addRotors(link.joint, model.dof(), parent, X_before, number, model);
      for (const detail::JointPart& part : detail::partsOf(link.joint.kind)) {
        const Transform<T> X_part = detail::asZ<T>(part.axis);
        LinkModel<T> out;
        out.parent = carrier[i];
        out.kind = part.kind;
        out.X_tree = part.axis == 2 ? X_tree : X_part * X_tree;
        if (part.kind != JointKind::kFixed) {
          const T gear = number(link.joint.gear_ratio);
          out.dof = model.dof();
          out.slot = model.positions;
          out.rotor = gear * gear * number(link.joint.rotor_inertia);
          if (link.joint.gyroscopic) out.spin = gear * number(link.joint.rotor_inertia);
          out.viscous = number(link.joint.friction.viscous);
          out.positive = number(link.joint.friction.positive);
          out.negative = number(link.joint.friction.negative);
          model.gyroscopic = model.gyroscopic || link.joint.gyroscopic;
          model.friction = model.friction || !link.joint.friction.isNone();
          out.stiffness = number(link.joint.stiffness);
          out.rest = number(link.joint.rest);
          out.pitch = number(link.joint.pitch);
          model.positions += part.slots;
          model.plain_joints = model.plain_joints && (part.kind == JointKind::kRevolute ||
                                                      part.kind == JointKind::kPrismatic);
          if (link.joint.mimic) {
            detail::follow(*follower++, number, out);
            model.plain_joints = false;
          } else {
            model.link_of_dof.insert(model.link_of_dof.end(), axisCount(part.kind),
                                     static_cast<int>(model.links.size()));
          }
        }
        carrier[i] = static_cast<int>(model.links.size());
        model.links.push_back(out);
        X_tree = X_part.inverse();
        X_back = part.axis == 2 ? X_z.inverse() : X_z.inverse() * X_tree;
      }
      X_carrier[i] = X_after * X_back;
      model.joints.push_back({carrier[i], X_back});
    }
    RigidInertia<T>& M = carrier[i] < 0 ? model.base : model.links[carrier[i]].M;
    M = M + X_carrier[i].inverseTimes(detail::rigidInertia<T>(link.inertia, number));
  }

  for (std::size_t i = 0; i < mechanism.links.size(); ++i)
    model.places.push_back({carrier[i], X_carrier[i]});
  model.coupled = model.coupled || !model.rotors.empty();
  std::vector<char> seen(model.coupled ? model.dof() : 0, 0);
  for (std::size_t i = model.links.size(); model.coupled && i-- > 0;)
    if (LinkModel<T>& link = model.links[i]; link.dof >= 0) {
      link.adds = seen[link.dof] != 0;
      seen[link.dof] = 1;
    }

  for (const scene::Wrench& wrench : mechanism.wrenches) {
    if (carrier[wrench.link] < 0) continue;  // on the world: moves nothing
    const int link = carrier[wrench.link];
    const Transform<T>& X = X_carrier[wrench.link];
    const Vector3<T> at = detail::vector<T>(wrench.at, number);
    const Vector3<T> force = detail::vector<T>(wrench.force, number);
    const Vector3<T> moment = detail::vector<T>(wrench.moment, number);
    if (wrench.axes == scene::Wrench::Axes::kWorld)
      model.world_loads.push_back({link, force, moment, X.p + X.R.transpose() * at});
    else
      model.links[link].load =
          model.links[link].load + X.inverseTimes(Force<T>{force, moment + at.cross(force)});
  }
  return model;
}

}  // namespace dynwitness::recursive
