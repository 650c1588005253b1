// SPDX-License-Identifier: GPL-3.0-or-later
// Lagrange's equations link by link in homogeneous 4 x 4 matrices: no spatial vector, no derived
// formula.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "recursive/factorization.hpp"
#include "scene/mimic.hpp"
#include "scene/numbers.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

template <typename T>
using Matrix4 = Eigen::Matrix<T, 4, 4>;
template <typename T>
using Vector4 = Eigen::Matrix<T, 4, 1>;

/// Which terms are asked for besides M qdd and the velocity products.
struct LagrangeTerms {
  bool gravity, springs, loads;  ///< loads: friction too
};

/** A mechanism as homogeneous matrices, read from the scene by itself.

    A link's frame is its moved joint frame. With A the link's frame seen from its parent's, W from
    the world's, E_k = [w]x with v beside it, the constant generator of axis k in the link's frame,
    and J the pseudo-inertia, the sum of m x x' over the link's points x = (x, y, z, 1):

        dA/dpi_k = A E_k                       pi_k: the k-th coordinate, or quasi-coordinate of a
                                               spherical or floating joint, whose rate is qd_k
        J = [ sum m x x'   m r_c ]             sum m x x' = (tr I / 2) 1 - I
            [ m r_c'       m     ]

    Lagrange's equations in the form that needs no gradient of T (Hollerbach): tau_k is the virtual
    work of the inertial forces of all points, whose places are W x,

        tau_k = sum over j outboard of tr( dW_j/dpi_k J_j Wdd_j' ) - loads
        dW_j/dpi_k = W_i E_k W_i^-1 W_j

    Cylindrical, universal and planar joints are chains of axes. Fixed joints are kept. Gyroscopic
    rotors are bodies. A joint that follows another has its leader's coordinate, and k times its own
    generator. */
template <typename T>
class HomogeneousModel {
 public:
  struct Axis {
    Matrix4<T> E;  ///< generator, in the frame after the joint
    T rotor;       ///< n^2 J [kg m^2], [kg]
  };
  struct Body {
    int parent = -1, dof = -1, slot = -1;  ///< dof: of the first axis
    bool rests = false;                    ///< in the world
    bool unfelt = false;                   ///< a rotor whose spin no link feels
    scene::JointKind kind = scene::JointKind::kFixed;
    Matrix4<T> before = Matrix4<T>::Identity();  ///< parent's frame to the unmoved joint frame
    Eigen::Matrix<T, 3, 1> k;                    ///< axis, in the joint frame
    T pitch = T(0), stiffness = T(0), rest = T(0);
    T viscous = T(0), positive = T(0), negative = T(0);  ///< friction
    T ratio = T(1);  ///< of a follower's rate to its leader's, whose `dof` it has
    bool follows = false, backward = false;  ///< backward: ratio < 0
    std::vector<Axis> axes;
    Matrix4<T> J = Matrix4<T>::Constant(T(0));
  };
  struct Load {
    int body;
    bool in_world;  ///< axes of force and moment
    Eigen::Matrix<T, 3, 1> force, moment;
    Vector4<T> at;  ///< of the body
  };

  template <typename Numbers>
  HomogeneousModel(const scene::Mechanism& mechanism, const Numbers& number);

  int dof() const { return dof_; }

  /** tau = M qdd + c + g - Q, by an outward sweep and an inward one, O(n):
        (1)  W = W_p A,   Wd = Wd_p A + W F,   F = sum of E_k qd_k
        (2)  Wdd = Wdd_p A + 2 Wd_p A F + W (F F + sum of E_k qdd_k)
        (3)  D = J Wdd' - J e_4 (gravity, 0)' - loads + sum over children of A_child D_child
        (4)  tau_k = tr(W E_k D) + n^2 J_rotor qdd_k + stiffness (q - rest)
      A force f at a point x does the virtual work tr(dW x (f, 0)'); a moment m turns by dR, which
      is tr(dR R' [m]x') / 2.
      @see J. Hollerbach, A Recursive Lagrangian Formulation of Manipulator Dynamics, IEEE Trans.
        Systems, Man, and Cybernetics 10 (1980) */
  std::vector<T> inverse(const std::vector<scene::JointPosition<T>>& x, const std::vector<T>& qd,
                         const std::vector<T>& qdd, LagrangeTerms terms);
  /// Column j is inverse() at rest for a unit acceleration of joint j alone, where (2) leaves
  /// Wdd = Wdd_p A + W E_j, and nothing but what joint j carries is accelerated.
  MatrixX<T> massMatrix(const std::vector<scene::JointPosition<T>>& x);
  /// sum tr(Wd J Wd') / 2 + sum n^2 J_rotor qd^2 / 2 [J]
  T kinetic(const std::vector<scene::JointPosition<T>>& x, const std::vector<T>& qd);
  /// - sum gravity' (W J e_4) + sum stiffness (q - rest)^2 / 2 [J]
  T potential(const std::vector<scene::JointPosition<T>>& x);
  /// From sum of Wd J W' : m v in its last column, sum m x x v in its skew part. World axes and
  /// origin.
  MatrixX<T> momentum(const std::vector<scene::JointPosition<T>>& x, const std::vector<T>& qd);

  /** Second derivatives of all bodies' W: how the first along constant rates v changes along
      constant rates u. Where qd are derivatives of q: sum u_i v_j d2W/dq_i dq_j, and u and v may
      change places; elsewhere they differ by the commutator of the two. Where x is the place of a
      point, that is how the motion bends in the space of all points. */
  std::vector<Matrix4<T>> secondPartials(const std::vector<scene::JointPosition<T>>& x,
                                         const std::vector<T>& u, const std::vector<T>& v);
  /** The same of one body alone, and its Wd: through what carries it. Positions as in the last call
      of anything that takes them. */
  struct Partials {
    Matrix4<T> first, second;  ///< Wd along v; how it changes along u
  };
  Partials partialsOf(std::size_t body, const std::vector<T>& u, const std::vector<T>& v) const;
  /// W and A of all bodies.
  void place(const std::vector<scene::JointPosition<T>>& x);
  /// sum over all points of m (a x)' (b x), for matrices a, b by body.
  T weighted(const std::vector<Matrix4<T>>& a, const std::vector<Matrix4<T>>& b) const;
  /// weighted(dW/dq_k, b) for every k, by the inward sweep (3), (4). Positions as in the last call.
  std::vector<T> weightedWithFirst(const std::vector<Matrix4<T>>& b);
  /// Where each body is: W of the last call.
  const std::vector<Matrix4<T>>& places() const { return W_; }
  /// How each body moves: Wd of the last call of kinetic().
  const std::vector<Matrix4<T>>& rates() const { return Wd_; }

  std::vector<Body> bodies;
  std::vector<int> body_of_link;          ///< by link of the scene
  std::vector<Matrix4<T>> after_of_link;  ///< body's frame to the scene's link frame
  std::vector<Load> loads;
  Vector4<T> gravity = Vector4<T>::Constant(T(0));  ///< (gravity, 0)

 private:
  using Vector3 = Eigen::Matrix<T, 3, 1>;
  using Matrix3 = Eigen::Matrix<T, 3, 3>;

  static Matrix3 hat(const Vector3& r) {
    Matrix3 m;
    m << T(0), -r(2), r(1), r(2), T(0), -r(0), -r(1), r(0), T(0);
    return m;
  }
  static Matrix4<T> joined(const Matrix3& R, const Vector3& p, int corner) {
    Matrix4<T> A = Matrix4<T>::Constant(T(0));
    A.template topLeftCorner<3, 3>() = R;
    A.template topRightCorner<3, 1>() = p;
    A(3, 3) = T(corner);
    return A;
  }
  /// Turn about a unit vector: c 1 + (1 - c) k k' + s [k]x
  static Matrix3 turn(const Vector3& k, const T& c, const T& s) {
    return Matrix3::Identity() * c + k * k.transpose() * (T(1) - c) + hat(k) * s;
  }
  template <typename Numbers>
  static Vector3 vector(const scene::Vector& v, const Numbers& number) {
    return {number(v[0]), number(v[1]), number(v[2])};
  }
  template <typename Numbers>
  static Matrix4<T> composed(const std::vector<scene::Step>& steps, const Numbers& number);
  template <typename Numbers>
  static Matrix4<T> pseudoInertia(const scene::MassProperties& m, const Numbers& number);

  /// How far the scene has been read: the body and the frame that come next are fixed to, and the
  /// first slot and follower that are free.
  struct Reading {
    int parent = -1, slot = 0;
    Matrix4<T> placed = Matrix4<T>::Identity();
    std::vector<scene::Follower>::const_iterator follower;
  };
  template <typename Numbers>
  void addLink(const scene::Link& link, Reading* at, const Numbers& number);
  /// The link's joint, or one of the chain that it is, about k.
  template <typename Numbers>
  void addJoint(const scene::Joint& joint, scene::JointKind kind, const Vector3& k, Reading* at,
                const Numbers& number);
  template <typename Numbers>
  void addLoad(const scene::Wrench& wrench, const Numbers& number);

  /** A gyroscopic rotor is a body of its own, which its joint's coordinate turns gear_ratio times
      as far about the joint's axis on the link that carries it; that link then lacks it. Where it
      has been turned to makes no difference, so it is left unturned and only its generator tells of
      its motion. */
  void addRotor(const Body& joint, const T& gear, const T& J_rotor);
  /** A rotor geared to all rates of a joint is such a body, too, with one generator a rate: tau is
      the virtual work of the inertial forces of its points. One that is not gyroscopic turns in the
      world.
      @param place  where it stands: on which body, and the frame of its axis there */
  template <typename Numbers>
  void addGearedRotor(const scene::Rotor& rotor, const Body& place, const Numbers& number);

  /// A of a joint at this position.
  Matrix4<T> moved(const Body& body, const std::vector<scene::JointPosition<T>>& x) const;
  Matrix4<T> generator(const Body& body, const std::vector<T>& rates) const {
    Matrix4<T> F = Matrix4<T>::Constant(T(0));
    for (std::size_t k = 0; k < body.axes.size(); ++k) F += body.axes[k].E * rates[body.dof + k];
    return F;
  }
  void move(const std::vector<T>& qd);  ///< Wd of all bodies, after place()
  /// tau_k = tr(W E_k D), D carried inward.
  std::vector<T> inward(std::vector<Matrix4<T>> D) const;
  static T trace(const Matrix4<T>& a, const Matrix4<T>& b) {  // tr(a b')
    T sum = T(0);
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) sum += a(i, j) * b(i, j);
    return sum;
  }

  int dof_ = 0;
  std::vector<Matrix4<T>> W_, A_, Wd_;
};

// ---- reading the scene --------------------------------------------------------------------------

template <typename T>
template <typename Numbers>
Matrix4<T> HomogeneousModel<T>::composed(const std::vector<scene::Step>& steps,
                                         const Numbers& number) {
  using Kind = scene::Step::Kind;
  Matrix4<T> A = Matrix4<T>::Identity();
  for (const scene::Step& step : steps) {
    if (step.kind == Kind::kTranslate) {
      const Vector3 p = vector(step.translation, number);
      A = A * joined(Matrix3::Identity(), p, 1);
      continue;
    }
    const int axis = step.kind == Kind::kRotateX ? 0 : step.kind == Kind::kRotateY ? 1 : 2;
    const scene::CosSin<T> angle = number.angle(step.angle);
    A = A * joined(turn(Vector3::Unit(axis), angle.c, angle.s), Vector3::Constant(T(0)), 1);
  }
  return A;
}

template <typename T>
template <typename Numbers>
Matrix4<T> HomogeneousModel<T>::pseudoInertia(const scene::MassProperties& m,
                                              const Numbers& number) {
  Matrix3 I;
  const T xy = number(m.xy), xz = number(m.xz), yz = number(m.yz);
  I << number(m.xx), xy, xz, xy, number(m.yy), yz, xz, yz, number(m.zz);
  const Matrix3 points = Matrix3::Identity() * ((I(0, 0) + I(1, 1) + I(2, 2)) / T(2)) - I;
  const scene::CosSin<T> roll = number.angle(m.rpy[0]), pitch = number.angle(m.rpy[1]),
                         yaw = number.angle(m.rpy[2]);
  const Matrix3 R = turn(Vector3::Unit(2), yaw.c, yaw.s) *
                    turn(Vector3::Unit(1), pitch.c, pitch.s) *
                    turn(Vector3::Unit(0), roll.c, roll.s);
  const Matrix3 turned = R * points * R.transpose();
  const T mass = number(m.mass);
  const Vector3 c = vector(m.com, number), h = c * mass;
  Matrix4<T> J = joined(turned, h, 0);
  if (m.about == scene::MassProperties::About::kCenterOfMass)
    J.template topLeftCorner<3, 3>() += h * c.transpose();
  J.template bottomLeftCorner<1, 3>() = h.transpose();
  J(3, 3) = mass;
  return J;
}

template <typename T>
void HomogeneousModel<T>::addRotor(const Body& joint, const T& gear, const T& J_rotor) {
  Body rotor;
  rotor.parent = joint.parent;
  rotor.dof = joint.dof;
  rotor.slot = joint.slot;
  rotor.before = joint.before;
  rotor.k = joint.k;
  rotor.axes.push_back({joined(hat(joint.k) * gear, Vector3::Constant(T(0)), 0), T(0)});
  // sum m x x' of a ring about k: J / 2 along all that is across k
  const Matrix3 ring = (Matrix3::Identity() - joint.k * joint.k.transpose()) * (J_rotor / T(2));
  rotor.J = joined(ring, Vector3::Constant(T(0)), 0);
  bodies[rotor.parent].J -= rotor.before * rotor.J * rotor.before.transpose();
  bodies.push_back(rotor);
}

template <typename T>
template <typename Numbers>
void HomogeneousModel<T>::addGearedRotor(const scene::Rotor& given, const Body& place,
                                         const Numbers& number) {
  const bool on_fixed = place.parent < 0 || bodies[place.parent].rests;
  Body rotor;
  rotor.dof = place.dof;
  rotor.slot = place.slot;
  rotor.unfelt = on_fixed || !given.axis;
  Vector3 a = Vector3::Unit(2);
  if (!rotor.unfelt) {
    rotor.parent = place.parent;
    rotor.before = place.before;
    const scene::AxisTurn<T> turned = number.axisTurn(*given.axis);
    a = Vector3(turned.alpha.c * turned.beta.s, turned.alpha.s * turned.beta.s, turned.beta.c);
  }
  const T J = number(given.inertia);
  for (const scene::Number& n : given.ratio)
    rotor.axes.push_back({joined(hat(a) * number(n), Vector3::Constant(T(0)), 0), T(0)});
  const Matrix3 ring = (Matrix3::Identity() - a * a.transpose()) * (J / T(2));
  rotor.J = joined(ring, Vector3::Constant(T(0)), 0);
  if (!rotor.unfelt) bodies[rotor.parent].J -= rotor.before * rotor.J * rotor.before.transpose();
  bodies.push_back(rotor);
}

template <typename T>
template <typename Numbers>
HomogeneousModel<T>::HomogeneousModel(const scene::Mechanism& mechanism, const Numbers& number) {
  if (mechanism.has_gravity) gravity.template head<3>() = vector(mechanism.gravity, number);
  const std::vector<scene::Follower> followers = scene::followers(mechanism);
  Reading at;
  at.follower = followers.begin();
  for (const scene::Link& link : mechanism.links) addLink(link, &at, number);
  for (const scene::Wrench& wrench : mechanism.wrenches) addLoad(wrench, number);
}

template <typename T>
template <typename Numbers>
void HomogeneousModel<T>::addLink(const scene::Link& link, Reading* at, const Numbers& number) {
  using Kind = scene::JointKind;
  at->parent = link.parent < 0 ? -1 : body_of_link[link.parent];
  at->placed = composed(link.joint.placement.beforeJoint(), number);
  if (link.parent >= 0) at->placed = after_of_link[link.parent] * at->placed;
  const scene::AxisTurn<T> turned = number.axisTurn(link.joint.axis);
  const T &ca = turned.alpha.c, &sa = turned.alpha.s, &cb = turned.beta.c, &sb = turned.beta.s;
  const Vector3 x(ca * cb, sa * cb, -sb), y(-sa, ca, T(0)), z(ca * sb, sa * sb, cb);
  if (!link.joint.rotors.empty()) {
    Body place;
    place.parent = at->parent;
    place.before = at->placed;
    place.dof = dof_;
    place.slot = at->slot;
    for (const scene::Rotor& rotor : link.joint.rotors) addGearedRotor(rotor, place, number);
  }
  const auto add = [&](Kind kind, const Vector3& k) { addJoint(link.joint, kind, k, at, number); };
  switch (link.joint.kind) {
    case Kind::kCylindrical:
      add(Kind::kPrismatic, z), add(Kind::kRevolute, z);
      break;
    case Kind::kUniversal:
      add(Kind::kRevolute, x), add(Kind::kRevolute, y);
      break;
    case Kind::kPlanar:
      add(Kind::kPrismatic, x), add(Kind::kPrismatic, y), add(Kind::kRevolute, z);
      break;
    default:
      add(link.joint.kind, z);
  }
  const Matrix4<T> after = composed(link.joint.placement.afterJoint(), number);
  bodies.back().J = after * pseudoInertia(link.inertia, number) * after.transpose();
  body_of_link.push_back(at->parent);
  after_of_link.push_back(after);
}

template <typename T>
template <typename Numbers>
void HomogeneousModel<T>::addJoint(const scene::Joint& joint, scene::JointKind kind,
                                   const Vector3& k, Reading* at, const Numbers& number) {
  using Kind = scene::JointKind;
  Body body;
  body.parent = at->parent;
  body.kind = kind;
  body.before = at->placed;
  body.k = k;
  body.pitch = number(joint.pitch);
  body.stiffness = number(joint.stiffness);
  body.rest = number(joint.rest);
  body.viscous = number(joint.friction.viscous);
  body.positive = number(joint.friction.positive);
  body.negative = number(joint.friction.negative);
  T gear = number(joint.gear_ratio);
  const T J_rotor = number(joint.rotor_inertia);
  if (joint.mimic) {
    body.follows = true;
    body.backward = at->follower->multiplier < 0;
    body.ratio = number(scene::Number(at->follower->multiplier));
    gear *= body.ratio;
  }
  // on what rests in the world, only its joint feels it
  const bool on_fixed = body.parent < 0 || bodies[body.parent].rests;
  const bool spins = joint.gyroscopic && !on_fixed;
  body.rests = kind == Kind::kFixed && on_fixed;
  const T rotor = spins ? T(0) : T(gear * gear * J_rotor);
  const Vector3 none = Vector3::Constant(T(0));
  const auto axis = [&](const Vector3& w, const Vector3& v) {
    body.axes.push_back({joined(hat(w), v, 0), rotor});
    if (body.follows) body.axes.back().E *= body.ratio;
  };
  if (kind == Kind::kRevolute) axis(k, none);
  if (kind == Kind::kPrismatic) axis(none, k);
  if (kind == Kind::kHelical) axis(k, k * body.pitch);
  if (kind == Kind::kFloating)
    for (int i = 0; i < 3; ++i) axis(none, Vector3::Unit(i));
  if (kind == Kind::kFloating || kind == Kind::kSpherical)
    for (int i = 0; i < 3; ++i) axis(Vector3::Unit(i), none);
  if (!body.axes.empty()) {
    body.dof = body.follows ? (at->follower++)->rate : dof_;
    body.slot = at->slot;
    if (!body.follows) dof_ += static_cast<int>(body.axes.size());
    at->slot += kind == Kind::kFloating ? 7 : kind == Kind::kSpherical ? 4 : 1;
  }
  if (spins) addRotor(body, gear, J_rotor);
  at->parent = static_cast<int>(bodies.size());
  at->placed = Matrix4<T>::Identity();
  bodies.push_back(body);
}

template <typename T>
template <typename Numbers>
void HomogeneousModel<T>::addLoad(const scene::Wrench& wrench, const Numbers& number) {
  const Matrix4<T>& after = after_of_link[wrench.link];
  Vector4<T> at = Vector4<T>::Constant(T(1));
  at.template head<3>() = vector(wrench.at, number);
  Load load = {body_of_link[wrench.link], wrench.axes == scene::Wrench::Axes::kWorld,
               vector(wrench.force, number), vector(wrench.moment, number), after * at};
  if (!load.in_world) {  // to the body's axes
    load.force = after.template topLeftCorner<3, 3>() * load.force;
    load.moment = after.template topLeftCorner<3, 3>() * load.moment;
  }
  loads.push_back(load);
}

// ---- sweeps -------------------------------------------------------------------------------------

template <typename T>
Matrix4<T> HomogeneousModel<T>::moved(const Body& body,
                                      const std::vector<scene::JointPosition<T>>& x) const {
  using Kind = scene::JointKind;
  Matrix3 R = Matrix3::Identity();
  Vector3 p = Vector3::Constant(T(0));
  int slot = body.slot;
  if (body.kind == Kind::kRevolute || body.kind == Kind::kHelical)
    R = turn(body.k, x[slot].c, x[slot].s);
  if (body.kind == Kind::kPrismatic) p = body.k * x[slot].q;
  if (body.kind == Kind::kHelical) p = body.k * (body.pitch * x[slot].q);
  if (body.kind == Kind::kFloating) {
    p = Vector3(x[slot].q, x[slot + 1].q, x[slot + 2].q);
    slot += 3;
  }
  if (body.kind == Kind::kFloating || body.kind == Kind::kSpherical) {
    // the quaternion (w, v) of any length: x -> ((w^2 - v'v) x + 2 v v'x + 2 w v x x) / (w^2 + v'v)
    const std::array<T, 4> q = scene::quaternionAt(&x[slot]);
    const T& w = q[0];
    const Vector3 v(q[1], q[2], q[3]);
    const T vv = v.dot(v), scale = T(1) / (w * w + vv);
    R = (Matrix3::Identity() * (w * w - vv) + v * v.transpose() * T(2) + hat(v) * (T(2) * w)) *
        scale;
  }
  return body.before * joined(R, p, 1);
}

template <typename T>
void HomogeneousModel<T>::place(const std::vector<scene::JointPosition<T>>& x) {
  W_.clear();
  A_.clear();
  for (const Body& body : bodies) {
    A_.push_back(moved(body, x));
    W_.push_back(body.parent < 0 ? A_.back() : Matrix4<T>(W_[body.parent] * A_.back()));
  }
}

template <typename T>
void HomogeneousModel<T>::move(const std::vector<T>& qd) {
  Wd_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    Matrix4<T> Wd = W_[i] * generator(body, qd);
    if (body.parent >= 0) Wd += Wd_[body.parent] * A_[i];
    Wd_.push_back(Wd);
  }
}

template <typename T>
std::vector<T> HomogeneousModel<T>::inward(std::vector<Matrix4<T>> D) const {
  std::vector<T> tau(dof_, T(0));
  for (std::size_t i = bodies.size(); i-- > 0;) {
    const Body& body = bodies[i];
    for (std::size_t k = 0; k < body.axes.size(); ++k)
      tau[body.dof + k] += trace(W_[i] * body.axes[k].E, D[i].transpose());  // (4)
    if (body.parent >= 0) D[body.parent] += A_[i] * D[i];                    // (3), children
  }
  return tau;
}

template <typename T>
std::vector<T> HomogeneousModel<T>::inverse(const std::vector<scene::JointPosition<T>>& x,
                                            const std::vector<T>& qd, const std::vector<T>& qdd,
                                            LagrangeTerms terms) {
  place(x);
  move(qd);  // (1)
  std::vector<Matrix4<T>> Wdd, D;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const Matrix4<T> F = generator(body, qd);
    Matrix4<T> a = W_[i] * (F * F + generator(body, qdd));
    if (body.parent >= 0) a += Wdd[body.parent] * A_[i] + Wd_[body.parent] * A_[i] * F * T(2);
    Wdd.push_back(a);  // (2)
    D.push_back(body.J * a.transpose());
    if (terms.gravity) D[i] -= body.J.col(3) * gravity.transpose();  // (3), own part
  }
  if (terms.loads) {
    for (const Load& load : loads) {
      const Matrix3 R = W_[load.body].template topLeftCorner<3, 3>();
      Vector4<T> f = Vector4<T>::Constant(T(0));
      f.template head<3>() = load.in_world ? load.force : Vector3(R * load.force);
      D[load.body] -= load.at * f.transpose();
      // R' [m]x' = [R' m]x' R'
      const Matrix3 couple = load.in_world ? Matrix3(R.transpose() * hat(load.moment).transpose())
                                           : Matrix3(hat(load.moment).transpose() * R.transpose());
      D[load.body].template topLeftCorner<3, 3>() -= couple * (T(1) / T(2));
    }
  }
  std::vector<T> tau = inward(std::move(D));
  for (const Body& body : bodies) {
    for (std::size_t k = 0; k < body.axes.size(); ++k)
      tau[body.dof + k] += body.axes[k].rotor * qdd[body.dof + k];
    if (body.axes.size() != 1) continue;
    T own = T(0);  // in the joint's own coordinate
    if (terms.springs) own += body.stiffness * (x[body.slot].q - body.rest);
    if (terms.loads) {
      using scene::directionOf;
      const int direction = body.backward ? -directionOf(qd[body.dof]) : directionOf(qd[body.dof]);
      own += body.viscous * (body.follows ? T(body.ratio * qd[body.dof]) : qd[body.dof]);
      if (direction > 0) own += body.positive;
      if (direction < 0) own -= body.negative;
    }
    tau[body.dof] += body.follows ? T(body.ratio * own) : own;
  }
  return tau;
}

template <typename T>
MatrixX<T> HomogeneousModel<T>::massMatrix(const std::vector<scene::JointPosition<T>>& x) {
  place(x);
  MatrixX<T> M = MatrixX<T>::Constant(dof_, dof_, T(0));
  std::vector<std::vector<Matrix4<T>>> dW;  // by body and axis: W E_k
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    dW.emplace_back();
    for (const Axis& axis : bodies[i].axes) dW.back().push_back(W_[i] * axis.E);
  }
  std::vector<Matrix4<T>> Wdd(bodies.size()), D(bodies.size());
  for (int j = 0; j < dof_; ++j) {
    std::vector<char> is_accelerated(bodies.size(), 0), has_force(bodies.size(), 0);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Body& body = bodies[i];
      const int k = j - body.dof;
      const bool by_own = k >= 0 && k < static_cast<int>(body.axes.size()),
                 by_parent = body.parent >= 0 && is_accelerated[body.parent] != 0;
      if (by_own && by_parent)
        Wdd[i] = dW[i][k] + Wdd[body.parent] * A_[i];
      else if (by_own)
        Wdd[i] = dW[i][k];
      else if (by_parent)
        Wdd[i] = Wdd[body.parent] * A_[i];
      else
        continue;
      is_accelerated[i] = has_force[i] = 1;
      D[i] = body.J * Wdd[i].transpose();
    }
    for (std::size_t i = bodies.size(); i-- > 0;) {
      if (has_force[i] == 0) continue;
      const Body& body = bodies[i];
      for (std::size_t k = 0; k < body.axes.size(); ++k)
        M(body.dof + static_cast<int>(k), j) += trace(dW[i][k], D[i].transpose());
      if (body.parent < 0) continue;
      if (has_force[body.parent] != 0)
        D[body.parent] += A_[i] * D[i];
      else
        D[body.parent] = A_[i] * D[i];
      has_force[body.parent] = 1;
    }
    for (const Body& body : bodies)
      for (std::size_t k = 0; k < body.axes.size(); ++k)
        if (body.dof + static_cast<int>(k) == j) M(j, j) += body.axes[k].rotor;
  }
  return M;
}

template <typename T>
T HomogeneousModel<T>::kinetic(const std::vector<scene::JointPosition<T>>& x,
                               const std::vector<T>& qd) {
  place(x);
  move(qd);
  T twice = T(0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    twice += trace(Wd_[i] * bodies[i].J, Wd_[i]);
    for (std::size_t k = 0; k < bodies[i].axes.size(); ++k) {
      const T& rate = qd[bodies[i].dof + k];
      twice += bodies[i].axes[k].rotor * rate * rate;
    }
  }
  return twice / T(2);
}

template <typename T>
T HomogeneousModel<T>::potential(const std::vector<scene::JointPosition<T>>& x) {
  place(x);
  T weight = T(0), twice_springs = T(0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    weight += gravity.dot(Vector4<T>(W_[i] * body.J.col(3)));
    if (body.axes.size() == 1) {
      const T stretch = x[body.slot].q - body.rest;
      twice_springs += body.stiffness * stretch * stretch;
    }
  }
  return twice_springs / T(2) - weight;
}

template <typename T>
MatrixX<T> HomogeneousModel<T>::momentum(const std::vector<scene::JointPosition<T>>& x,
                                         const std::vector<T>& qd) {
  place(x);
  move(qd);
  Matrix4<T> S = Matrix4<T>::Constant(T(0));
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!bodies[i].unfelt) S += Wd_[i] * bodies[i].J * W_[i].transpose();
  MatrixX<T> out(6, 1);
  out << S(0, 3), S(1, 3), S(2, 3), S(2, 1) - S(1, 2), S(0, 2) - S(2, 0), S(1, 0) - S(0, 1);
  return out;
}

template <typename T>
std::vector<Matrix4<T>> HomogeneousModel<T>::secondPartials(
    const std::vector<scene::JointPosition<T>>& x, const std::vector<T>& u,
    const std::vector<T>& v) {
  place(x);
  move(v);
  const std::vector<Matrix4<T>> along_v = Wd_;
  move(u);
  std::vector<Matrix4<T>> out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const Matrix4<T> F_u = generator(body, u), F_v = generator(body, v);
    Matrix4<T> second = W_[i] * F_u * F_v;  // E is constant, and one axis commutes with itself
    if (body.parent >= 0)
      second += out[body.parent] * A_[i] + (Wd_[body.parent] * A_[i]) * F_v +
                (along_v[body.parent] * A_[i]) * F_u;
    out.push_back(second);
  }
  return out;
}

template <typename T>
typename HomogeneousModel<T>::Partials HomogeneousModel<T>::partialsOf(
    std::size_t body, const std::vector<T>& u, const std::vector<T>& v) const {
  std::vector<int> path;
  for (int i = static_cast<int>(body); i >= 0; i = bodies[i].parent) path.push_back(i);
  Partials out;
  Matrix4<T> along_u;
  for (auto i = path.rbegin(); i != path.rend(); ++i) {  // as move() and secondPartials()
    const Body& one = bodies[*i];
    const Matrix4<T> F_u = generator(one, u), F_v = generator(one, v);
    Matrix4<T> first = W_[*i] * F_v, first_u = W_[*i] * F_u;
    Matrix4<T> second = first_u * F_v;
    if (one.parent >= 0) {
      const Matrix4<T> carried_u = along_u * A_[*i], carried_v = out.first * A_[*i];
      second += out.second * A_[*i] + carried_u * F_v + carried_v * F_u;
      first += carried_v;
      first_u += carried_u;
    }
    along_u = first_u;
    out.first = first;
    out.second = second;
  }
  return out;
}

template <typename T>
T HomogeneousModel<T>::weighted(const std::vector<Matrix4<T>>& a,
                                const std::vector<Matrix4<T>>& b) const {
  T sum = T(0);
  for (std::size_t i = 0; i < bodies.size(); ++i) sum += trace(a[i] * bodies[i].J, b[i]);
  return sum;
}

template <typename T>
std::vector<T> HomogeneousModel<T>::weightedWithFirst(const std::vector<Matrix4<T>>& b) {
  std::vector<Matrix4<T>> D;
  for (std::size_t i = 0; i < bodies.size(); ++i) D.push_back(bodies[i].J * b[i].transpose());
  return inward(std::move(D));
}

/// The witness in any arithmetic.
template <typename T>
struct RecursiveLagrange {
  static constexpr const char* kName = "recursive_lagrange";
  static bool answers(Quantity quantity) { return quantity != Quantity::kReactions; }

  template <typename Numbers>
  RecursiveLagrange(const scene::Mechanism& mechanism, const Numbers& number)
      : model(mechanism, number) {}

  MatrixX<T> operator()(Quantity quantity, const scene::State<T>& state) {
    const std::vector<T> zeros(model.dof(), T(0));
    switch (quantity) {
      case Quantity::kM:
        return model.massMatrix(state.x);
      case Quantity::kc:
        return column(model.inverse(state.x, state.qd, zeros, {false, false, false}));
      case Quantity::kg:
        return column(model.inverse(state.x, zeros, zeros, {true, true, false}));
      case Quantity::kTau:
        return column(model.inverse(state.x, state.qd, state.qdd, {true, true, true}));
      case Quantity::kKinetic:
        return scalar(model.kinetic(state.x, state.qd));
      case Quantity::kPotential:
        return scalar(model.potential(state.x));
      case Quantity::kMomentum:
        return model.momentum(state.x, state.qd);
      case Quantity::kQdd:
      case Quantity::kReactions:  // not answered
        break;
    }
    // M qdd = tau - tau at qdd = 0
    const std::vector<T> bias = model.inverse(state.x, state.qd, zeros, {true, true, true});
    std::vector<T> qdd = state.tau;
    for (std::size_t i = 0; i < qdd.size(); ++i) qdd[i] -= bias[i];
    MatrixX<T> M = model.massMatrix(state.x);
    recursive::factorize(M);
    recursive::solve(M, qdd);
    return column(qdd);
  }

  HomogeneousModel<T> model;
};

// compiled once, in recursive_lagrange_bounds.cpp and recursive_lagrange_exact.cpp
#define DYNWITNESS_RECURSIVE_LAGRANGE(PREFIX, T, NUMBERS)                                         \
  PREFIX template class HomogeneousModel<T>;                                                      \
  PREFIX template HomogeneousModel<T>::HomogeneousModel(const scene::Mechanism&, const NUMBERS&); \
  PREFIX template struct RecursiveLagrange<T>

DYNWITNESS_RECURSIVE_LAGRANGE(extern, RunningError, RunningErrorNumbers);
DYNWITNESS_RECURSIVE_LAGRANGE(extern, AdjointError, AdjointErrorNumbers);
DYNWITNESS_RECURSIVE_LAGRANGE(extern, PrimeField, FieldNumbers);

}  // namespace dynwitness::crosscheck
