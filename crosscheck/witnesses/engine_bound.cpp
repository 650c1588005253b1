// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_bound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "crosscheck/witnesses/frame_jacobian.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

using Rates = std::vector<RunningError>;
using Link = recursive::LinkModel<RunningError>;
using Vector3 = recursive::Vector3<RunningError>;

// What the header derives, in the norm of vectors and matrices.
constexpr double u = RunningError::kUnitRoundoff;
constexpr double kProduct = 3 * u;          ///< a x b, a b: of |a| |b|
constexpr double kTurn = 6 * u;             ///< R r: of |r|
constexpr double kTurnInertia = 12 * u;     ///< R' I R: of |I|
constexpr double kQuaternion = 26 * u;      ///< of an orientation that a quaternion gives, besides
constexpr double kRotationVector = 41 * u;  ///< of one that a rotation vector gives

/// What depends on how orientations are kept.
struct Turns {
  explicit Turns(double matrices) : turn_turn(9 * u * matrices), quarter_turns(5 * u * matrices) {}

  double turn_turn;                     ///< R Q, an orientation from two
  double quarter_turns;                 ///< of an orientation that is given by angles
  double axis = 10 * u + turn_turn;     ///< of a joint's axis
  double own_axes = 2 * 3 * turn_turn;  ///< of an inertia in axes of its own, three turns: of |I|
};

/// How large something is, and how far an engine's number for it may be off.
struct Size {
  double size = 0, error = 0;

  /// Seen in axes that are uncertain by so much.
  Size turned(double uncertainty) const { return {size, error + (uncertainty + kTurn) * size}; }
};
Size operator+(const Size& a, const Size& b) {
  return {a.size + b.size, a.error + b.error + u * (a.size + b.size)};
}
Size& operator+=(Size& a, const Size& b) {
  return a = a + b;
}
/// Of vectors of any direction: a x b as well as a'b.
Size operator*(const Size& a, const Size& b) {
  return {a.size * b.size,
          a.size * b.error + (b.size + b.error) * a.error + kProduct * a.size * b.size};
}

/// The norm of the values, and that of their bounds.
template <typename Derived>
Size sizeOf(const Eigen::DenseBase<Derived>& m) {
  double values = 0, bounds = 0;
  for (const RunningError& x : m.reshaped()) {
    values += x.value() * x.value();
    bounds += x.bound() * x.bound();
  }
  return {std::sqrt(values), std::sqrt(bounds)};
}
Size sizeOf(const RunningError& x) {
  return {std::abs(x.value()), x.bound()};
}

Size larger(const Size& a, const Size& b) {
  return {std::max(a.size, b.size), std::max(a.error, b.error)};
}

/// Of a motion or a force: (v, w), (f, m).
struct Pair {
  Size linear, angular;
};
Pair operator+(const Pair& a, const Pair& b) {
  return {a.linear + b.linear, a.angular + b.angular};
}

/// What is known of a link before it moves. An engine may refer it to the scene's link frame or to
/// its joint's, the model's, from which X leads there: sizes are the larger of both.
struct Body {
  recursive::Transform<RunningError> X = recursive::Transform<RunningError>::identity();
  double turn = 0;  ///< of the orientations at its joint, but for what the numbers are off
  Size reach;       ///< from the model's frame, the joint's, to the link's
  Size m, h, I;     ///< mass, first moment, inertia
  Pair load, world_load;
  Size gear, disc;  ///< of a gyroscopic rotor
};

/// The same mechanism as it goes through the sweeps: a position, the motion, the wrenches.
struct Passage {
  double turn = 0;                 ///< of the joint's orientations
  double turned = 0;               ///< of all orientations from the world to here
  Size lever;                      ///< from the parent to the joint
  Pair v, a;                       ///< of the link
  Pair momentum, inertial;         ///< of the link alone
  Pair f;                          ///< through the joint
  Size joint_moment;               ///< the moment about the joint
  Size rotor_speed, rotor_moment;  ///< of a gyroscopic rotor as a body of its own
};

template <typename Derived>
bool isIdentity(const Eigen::MatrixBase<Derived>& R) {
  const auto exact = R.unaryExpr([](const RunningError& x) { return x.value(); });
  return exact.template cast<double>() == Eigen::Matrix3d::Identity();
}

/// What is lost at a joint by turning: to multiply by an identity is exact.
double turnOf(const scene::Joint& joint, const RunningErrorNumbers& number, const Turns& by) {
  const auto turns = [&](const std::vector<scene::Step>& steps) {
    return !isIdentity(recursive::detail::composed<RunningError>(steps, number).R);
  };
  const bool along_z = joint.axis[0].isLiteralZero() && joint.axis[1].isLiteralZero();
  const int given = (turns(joint.placement.beforeJoint()) ? 1 : 0) +
                    (turns(joint.placement.afterJoint()) ? 1 : 0) +
                    (joint.kind != scene::JointKind::kFixed && !along_z ? 2 : 0);
  const bool moves =
      joint.kind != scene::JointKind::kFixed && joint.kind != scene::JointKind::kPrismatic;
  return (given + (moves ? 1 : 0)) * by.turn_turn + (given > 0 ? by.quarter_turns : 0);
}

/// Of the joint's axes: the rates of spherical and floating joints are turned into the engine's.
double axisUncertainty(const Link& link, const Passage& here, const Turns& by) {
  return recursive::axisCount(link.kind) >= 3 ? std::max(by.axis, here.turn) : by.axis;
}

/// The sweeps on (size, error).
struct SizedSweeps {
  SizedSweeps(const PreparedScene& scene, double matrices, Attitude attitude);

  void run(const scene::State<RunningError>& state, const Rates& qd, const Rates& qdd, Terms terms);
  void moveOutward(const scene::State<RunningError>& state, const Rates& qd, const Rates& qdd,
                   Terms terms);
  void loadInward(const Rates& qd, const Rates& qdd, Terms terms);
  Pair throughJoint(const Link& link, const Passage& here, const Rates& rates) const;
  void spinRotor(std::size_t i, const Rates& qd, const Rates& qdd);
  Size jointForce(const Link& link, int k, const Passage& here) const;
  /// run(), and the errors of tau.
  Eigen::VectorXd jointForces(const scene::State<RunningError>& state, const Rates& qd,
                              const Rates& qdd, Terms terms);

  Eigen::MatrixXd massMatrix(const scene::State<RunningError>& state);
  Eigen::VectorXd accelerations(const scene::State<RunningError>& state);
  // after run()
  double kinetic(const Rates& qd) const;
  double potential(const scene::State<RunningError>& state) const;
  Eigen::VectorXd momentum() const;
  Eigen::VectorXd reactions() const;
  /// Of the links in the world. @param origins  if given, becomes those of the model's frames
  std::vector<Size> places(std::vector<Eigen::Vector3d>* origins = nullptr) const;
  BoundedJacobian jacobian(const FramePoint& point, const scene::State<RunningError>& state);

  Turns turns;
  double by_attitude;  ///< what the orientation of a spherical or floating joint loses
  Setup<RunningError> setup;
  std::vector<Body> bodies;  ///< one a link of the model
  std::vector<Passage> at;
};

SizedSweeps::SizedSweeps(const PreparedScene& scene, double matrices, Attitude attitude)
    : turns(matrices),
      by_attitude(attitude == Attitude::kQuaternion ? kQuaternion : kRotationVector),
      setup(scene.modelWithFixedJoints<RunningError>()),
      bodies(setup.model.links.size()),
      at(setup.model.links.size()) {
  const scene::Mechanism& mechanism = scene.mechanism();
  const recursive::Model<RunningError>& model = setup.model;
  const RunningErrorNumbers number(mechanism);
  const auto vector = [&](const scene::Vector& v) {
    return sizeOf(recursive::detail::vector<RunningError>(v, number));
  };
  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const int carrier = model.places[i].link;
    if (carrier < 0) continue;
    Body& body = bodies[carrier];
    body.X = model.places[i].X;
    body.reach = sizeOf(body.X.p).turned(kTurn);
    const recursive::RigidInertia<RunningError> M =
        recursive::detail::rigidInertia<RunningError>(mechanism.links[i].inertia, number);
    body.m = sizeOf(M.mass);
    body.h = larger(sizeOf(M.h), sizeOf(model.links[carrier].M.h)).turned(0);
    body.I = larger(sizeOf(M.I.matrix()), sizeOf(model.links[carrier].M.I.matrix()));
    body.I.error += kTurnInertia * body.I.size;
    const scene::Vector& rpy = mechanism.links[i].inertia.rpy;
    if (!(rpy[0].isLiteralZero() && rpy[1].isLiteralZero() && rpy[2].isLiteralZero()))
      body.I.error += turns.own_axes * body.I.size;
    // the parts of one joint are all of its orientations
    const double turn = turnOf(mechanism.links[i].joint, number, turns);
    const int inboard =
        mechanism.links[i].parent < 0 ? -1 : model.places[mechanism.links[i].parent].link;
    for (int part = carrier; part != inboard; part = model.links[part].parent)
      bodies[part].turn = turn;
  }
  for (const scene::Wrench& wrench : mechanism.wrenches) {
    const int carrier = model.places[wrench.link].link;
    if (carrier < 0) continue;
    Body& body = bodies[carrier];
    const Size force = vector(wrench.force).turned(kTurn);
    const Pair load{force, vector(wrench.moment).turned(kTurn) +
                               (vector(wrench.at).turned(kTurn) + body.reach) * force};
    Pair& sum = wrench.axes == scene::Wrench::Axes::kWorld ? body.world_load : body.load;
    sum = sum + load;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Link& link = model.links[i];
    if (link.spin.value() == 0 || link.parent < 0) continue;
    const double gear = link.rotor.value() / link.spin.value(), J = link.spin.value() / gear;
    bodies[i].gear = {std::abs(gear), u * std::abs(gear)};
    bodies[i].disc = {std::abs(J), (kTurnInertia + turns.own_axes) * std::abs(J)};
  }
}

/// The motion at these rates, along axes of any direction.
Pair SizedSweeps::throughJoint(const Link& link, const Passage& here, const Rates& rates) const {
  if (link.dof < 0) return {};
  const recursive::Motion<RunningError> motion = recursive::AnyJoints::motion(link, rates);
  const double axis = axisUncertainty(link, here, turns);
  return {sizeOf(motion.linear).turned(axis), sizeOf(motion.angular).turned(axis)};
}

void SizedSweeps::run(const scene::State<RunningError>& state, const Rates& qd, const Rates& qdd,
                      Terms terms) {
  setup.inverse(state, qd, qdd, terms);
  moveOutward(state, qd, qdd, terms);
  loadInward(qd, qdd, terms);
}

/// The motion of the link's frame as well: v + w x r.
Pair seenFromLink(const Body& body, Pair x, const recursive::Motion<RunningError>& of_model) {
  if (body.reach.size == 0) return x;
  const double size = x.linear.size;
  x.linear += body.reach * x.angular;
  x.linear.size = std::max(size, sizeOf((body.X * of_model).linear).size);
  return x;
}

void SizedSweeps::moveOutward(const scene::State<RunningError>& state, const Rates& qd,
                              const Rates& qdd, Terms terms) {
  const Passage world;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Link& link = setup.model.links[i];
    const Body& body = bodies[i];
    Passage& here = at[i];
    const bool on_world = link.parent < 0;
    const Passage& inboard = on_world ? world : at[link.parent];
    const recursive::Transform<RunningError>& X = setup.ws.X_up[i];
    here.turn =
        body.turn + sizeOf(X.R).error + (recursive::axisCount(link.kind) >= 3 ? by_attitude : 0);
    here.turned = inboard.turned + here.turn;
    here.lever = sizeOf(X.p);
    if (!on_world) here.lever = larger(here.lever, sizeOf(Vector3(X.p - bodies[link.parent].X.p)));
    here.lever = here.lever.turned(kTurn);
    if (recursive::axisCount(link.kind) == 1 && link.kind != scene::JointKind::kRevolute) {
      const Size slide = sizeOf(state.x[link.slot].q);
      here.lever.error += turns.axis * slide.size *
                          (link.kind == scene::JointKind::kHelical ? sizeOf(link.pitch).size : 1);
    }

    const Pair v_J = throughJoint(link, here, qd), a_J = throughJoint(link, here, qdd);
    Pair a_p = inboard.a;
    if (on_world && terms.gravity) a_p.linear = sizeOf(setup.model.gravity);
    const auto passed = [&](const Pair& x) {
      return Pair{(x.linear + here.lever * x.angular).turned(here.turn),
                  x.angular.turned(here.turn)};
    };
    // v = X v_p + Z qd, and its size as it came out
    Pair v = passed(inboard.v) + v_J;
    v.linear.size = sizeOf(setup.ws.v[i].linear).size;
    v.angular.size = sizeOf(setup.ws.v[i].angular).size;
    // a = X a_p + Z qdd + v x Z qd
    Pair a = passed(a_p) + a_J;
    a.angular += v.angular * v_J.angular;
    a.linear += v.angular * v_J.linear + v.linear * v_J.angular;
    // engines with points' accelerations have w x (w x p) in place of v x w
    a.linear.error += (inboard.v.angular * (here.lever * inboard.v.angular)).error;
    a.linear.size = sizeOf(setup.ws.a[i].linear).size;
    a.angular.size = sizeOf(setup.ws.a[i].angular).size;
    v = here.v = seenFromLink(body, v, setup.ws.v[i]);
    a = here.a = seenFromLink(body, a, setup.ws.a[i]);
    here.momentum = {body.m * v.linear + body.h * v.angular,
                     body.I * v.angular + body.h * v.linear};
    const Pair& P = here.momentum;
    here.inertial = {
        body.m * a.linear + body.h * a.angular + v.angular * P.linear,
        body.I * a.angular + body.h * a.linear + v.angular * P.angular + v.linear * P.linear};
  }
}

/// A gyroscopic rotor as a body that turns gear times as fast as the joint, w = w_p + n z qd: the
/// moment that it exerts on its carrier, J dw/dt + w x J w.
void SizedSweeps::spinRotor(std::size_t i, const Rates& qd, const Rates& qdd) {
  const Link& link = setup.model.links[i];
  const Body& body = bodies[i];
  const Passage& carrier = at[link.parent];
  const Size axis{1, at[i].turn + turns.axis};
  const Size spin = body.gear * sizeOf(qd[link.dof]) * axis;
  const Size w = carrier.v.angular + spin;
  const Size w_rate =
      carrier.a.angular + body.gear * sizeOf(qdd[link.dof]) * axis + carrier.v.angular * spin;
  at[i].rotor_speed = w;
  at[i].rotor_moment = body.disc * w_rate + w * (body.disc * w);
}

void SizedSweeps::loadInward(const Rates& qd, const Rates& qdd, Terms terms) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    at[i].f = at[i].inertial;
    if (!terms.loads) continue;
    const Pair& world = bodies[i].world_load;
    at[i].f = at[i].f + bodies[i].load +
              Pair{world.linear.turned(at[i].turned), world.angular.turned(at[i].turned)};
  }
  for (std::size_t i = bodies.size(); i-- > 0;) {
    const Link& link = setup.model.links[i];
    const Size& reach = bodies[i].reach;
    Passage& here = at[i];
    // from the link frame to the joint, and its size as it came out
    const double moment = sizeOf(setup.ws.f[i].moment).size;
    here.f.linear.size = sizeOf(setup.ws.f[i].force).size;
    here.f.angular.size = std::max(moment, sizeOf((bodies[i].X * setup.ws.f[i]).moment).size);
    here.joint_moment = here.f.angular.turned(0);
    if (reach.size > 0) here.joint_moment += reach * here.f.linear;
    here.joint_moment.size = moment;
    if (link.parent < 0) continue;
    Pair& inboard = at[link.parent].f;
    if (bodies[i].disc.size > 0) {
      spinRotor(i, qd, qdd);
      inboard.angular += here.rotor_moment;
    }
    const Size force = here.f.linear.turned(here.turn);
    const Size moment_there = Size{here.f.angular.size, here.joint_moment.error}.turned(here.turn);
    inboard = inboard + Pair{force, moment_there + here.lever * force};
  }
}

/// Z_k' f
Size SizedSweeps::jointForce(const Link& link, int k, const Passage& here) const {
  const recursive::Vector6<RunningError> Z = recursive::jointAxis(link, k);
  const double uncertainty = axisUncertainty(link, here, turns);
  const auto along = [&](Size axis, const Size& f) {
    axis.error += uncertainty * axis.size;
    return axis.size == 0 ? Size{} : axis * f;
  };
  return along(sizeOf(Z.head<3>()), here.f.linear) + along(sizeOf(Z.tail<3>()), here.joint_moment);
}

/// tau = Z' f + d qdd + k (q - rest) + friction, and what the spinning of a rotor needs
Eigen::VectorXd SizedSweeps::jointForces(const scene::State<RunningError>& state, const Rates& qd,
                                         const Rates& qdd, Terms terms) {
  run(state, qd, qdd, terms);
  Eigen::VectorXd errors(setup.model.dof());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Link& link = setup.model.links[i];
    for (int k = 0; k < recursive::axisCount(link.kind); ++k) {
      Size tau = jointForce(link, k, at[i]) + sizeOf(link.rotor) * sizeOf(qdd[link.dof + k]);
      if (bodies[i].disc.size > 0) tau += bodies[i].gear * at[i].rotor_moment;
      if (k == 0 && terms.springs)
        tau += sizeOf(link.stiffness) * (sizeOf(state.x[link.slot].q) + sizeOf(link.rest));
      if (k == 0 && terms.friction)
        tau += sizeOf(link.viscous) * sizeOf(qd[link.dof]) + sizeOf(link.positive) +
               sizeOf(link.negative);
      errors(link.dof + k) = tau.error;
    }
  }
  return errors;
}

/// Column j: the forces of a unit acceleration of joint j alone. An engine may find either of two
/// equal entries.
Eigen::MatrixXd SizedSweeps::massMatrix(const scene::State<RunningError>& state) {
  const int n = setup.model.dof();
  Eigen::MatrixXd errors(n, n);
  for (int j = 0; j < n; ++j) {
    Rates unit = setup.zeros();
    unit[j] = 1;
    errors.col(j) = jointForces(state, setup.zeros(), unit, Terms::none());
  }
  return errors.cwiseMax(errors.transpose());
}

/// From the forces that qdd leaves unexplained: |M^-1| times their errors.
Eigen::VectorXd SizedSweeps::accelerations(const scene::State<RunningError>& state) {
  const auto value = [](const RunningError& x) { return x.value(); };
  const int n = setup.model.dof();
  const Eigen::MatrixXd M =
      CompositeBody::answer(setup, Quantity::kM, state).unaryExpr(value).template cast<double>();
  const MatrixX<RunningError> x = CompositeBody::answer(setup, Quantity::kQdd, state);
  const Eigen::VectorXd size = x.unaryExpr(value).template cast<double>().cwiseAbs();
  // elimination: (3 n + 1) u of |L| |D| |L'|, whose entries are below sqrt(M_ii M_jj)
  const Eigen::VectorXd diagonal = M.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd of_M =
      massMatrix(state) + (3 * n + 1) * u * diagonal * diagonal.transpose();
  Eigen::VectorXd forces = jointForces(state, state.qd, setup.zeros(), Terms::all()) + of_M * size;
  for (int i = 0; i < n; ++i) {
    const Link& link = setup.model.links[setup.model.link_of_dof[i]];
    const double turn = axisUncertainty(link, at[setup.model.link_of_dof[i]], turns);
    forces(i) +=
        state.tau[i].bound() + (2 * u + (recursive::axisCount(link.kind) >= 3 ? turn : 0)) *
                                   std::abs(state.tau[i].value());
  }
  const Eigen::MatrixXd inverse = M.fullPivLu().inverse().cwiseAbs();
  // M + dM is regular, and the first order tells all but its own square, where |M^-1| |dM| is well
  // below 1
  const double moved = (inverse * of_M).rowwise().sum().maxCoeff();
  if (!(moved < 0.5)) return Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
  return inverse * forces / (1 - moved);
}

double SizedSweeps::kinetic(const Rates& qd) const {
  Size twice;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Link& link = setup.model.links[i];
    const Passage& here = at[i];
    twice += here.v.linear * here.momentum.linear + here.v.angular * here.momentum.angular;
    for (int k = 0; k < recursive::axisCount(link.kind); ++k) {
      const Size rate = sizeOf(qd[link.dof + k]);
      twice += sizeOf(link.rotor) * rate * rate;
    }
    twice += bodies[i].disc * here.rotor_speed * here.rotor_speed;
  }
  return twice.error / 2;
}

std::vector<Size> SizedSweeps::places(std::vector<Eigen::Vector3d>* origins) const {
  std::vector<Size> out;
  std::vector<Eigen::Vector3d> p_W;
  std::vector<Eigen::Matrix3d> R_W;  // world axes to link axes
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const int parent = setup.model.links[i].parent;
    const auto value = [](const RunningError& x) { return x.value(); };
    const Eigen::Matrix3d R = setup.ws.X_up[i].R.unaryExpr(value).cast<double>();
    const Eigen::Vector3d p = setup.ws.X_up[i].p.unaryExpr(value).cast<double>();
    R_W.push_back(parent < 0 ? R : Eigen::Matrix3d(R * R_W[parent]));
    p_W.push_back(parent < 0 ? p : Eigen::Vector3d(p_W[parent] + R_W[parent].transpose() * p));
    Size place = parent < 0 ? at[i].lever : out[parent] + at[i].lever.turned(at[parent].turned);
    place.size = p_W.back().norm();
    out.push_back(place + bodies[i].reach.turned(at[i].turned));
  }
  if (origins != nullptr) *origins = p_W;
  return out;
}

/// V = -g' sum m p + sum k (q - rest)^2 / 2
double SizedSweeps::potential(const scene::State<RunningError>& state) const {
  const std::vector<Size> place = places();
  Size h_world = sizeOf(setup.model.base.h).turned(3 * turns.turn_turn), springs;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Link& link = setup.model.links[i];
    h_world += bodies[i].m * place[i] + bodies[i].h.turned(at[i].turned);
    if (link.dof < 0) continue;
    const Size stretch = sizeOf(state.x[link.slot].q) + sizeOf(link.rest);
    springs += sizeOf(link.stiffness) * stretch * stretch;
  }
  return (sizeOf(setup.model.gravity) * h_world + springs).error;
}

Eigen::VectorXd SizedSweeps::momentum() const {
  const std::vector<Size> place = places();
  Pair sum;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Pair& of_link = at[i].momentum;
    const Size linear = of_link.linear.turned(at[i].turned);
    sum = sum + Pair{linear, of_link.angular.turned(at[i].turned) + place[i] * linear};
    sum.angular += (bodies[i].disc * at[i].rotor_speed).turned(at[i].turned);
  }
  return (Eigen::VectorXd(6) << Eigen::Vector3d::Constant(sum.linear.error),
          Eigen::Vector3d::Constant(sum.angular.error))
      .finished();
}

Eigen::VectorXd SizedSweeps::reactions() const {
  const auto& joints = setup.model.joints;
  Eigen::VectorXd errors(6 * (joints.size() - 1));
  for (std::size_t i = 1; i < joints.size(); ++i) {
    const Passage& here = at[joints[i].link];
    errors.segment<3>(6 * (i - 1)).setConstant(here.f.linear.turned(here.turned).error);
    errors.segment<3>(6 * (i - 1) + 3).setConstant(here.joint_moment.turned(here.turned).error);
  }
  return errors;
}

/// Column by column, the motion of a unit rate.
BoundedJacobian SizedSweeps::jacobian(const FramePoint& point,
                                      const scene::State<RunningError>& state) {
  const recursive::Model<RunningError>& model = setup.model;
  const recursive::ScenePlace<RunningError>& place = model.places[point.link];
  const Vector3 arm = point.at.cast<RunningError>();
  BoundedJacobian out;
  out.value = out.bound = out.engine = Eigen::MatrixXd::Zero(6, model.dof());
  run(state, setup.zeros(), setup.zeros(), Terms::none());
  recursive::Transform<RunningError> X = place.X;  // world to link
  std::vector<bool> moves(bodies.size(), false);   // the link
  for (int i = place.link; i >= 0; i = model.links[i].parent) {
    X = X * setup.ws.X_up[i];
    moves[i] = true;
  }
  const auto value = [](const RunningError& x) { return x.value(); };
  out.axes = X.R.transpose().unaryExpr(value).cast<double>();
  out.origin = X.p.unaryExpr(value).cast<double>();
  out.point = out.origin + out.axes * point.at;
  if (place.link < 0) return out;
  std::vector<Eigen::Vector3d> origins;
  const std::vector<Size> places_W = places(&origins);
  const Size reach = sizeOf(arm).turned(0);
  for (int j = 0; j < model.dof(); ++j) {
    const int carrier = model.link_of_dof[j];
    if (!moves[carrier]) continue;  // exactly zero
    Rates unit = setup.zeros();
    unit[j] = 1;
    run(state, unit, setup.zeros(), Terms::none());
    const recursive::Motion<RunningError> v = place.X * setup.ws.v[place.link];
    const Vector3 linear = X.R.transpose() * (v.linear + v.angular.cross(arm)),
                  angular = X.R.transpose() * v.angular;
    for (int k = 0; k < 3; ++k) {
      out.value(k, j) = linear(k).value();
      out.bound(k, j) = linear(k).bound();
      out.value(3 + k, j) = angular(k).value();
      out.bound(3 + k, j) = angular(k).bound();
    }
    // by velocities, link by link
    const Passage& here = at[place.link];
    const Pair swept{(here.v.linear + reach * here.v.angular).turned(here.turned),
                     here.v.angular.turned(here.turned)};
    // by z x (p - p_j), of points of the world
    const Pair axis = throughJoint(model.links[carrier], at[carrier], unit);
    const double turned = at[carrier].turned;
    const Size between{
        (out.point - origins[carrier]).norm(),
        (places_W[place.link] + reach.turned(here.turned) + places_W[carrier]).error};
    const Pair crossed{axis.linear.turned(turned) + axis.angular.turned(turned) * between,
                       axis.angular.turned(turned)};
    out.engine.col(j).head<3>().setConstant(std::max(swept.linear.error, crossed.linear.error));
    out.engine.col(j).tail<3>().setConstant(std::max(swept.angular.error, crossed.angular.error));
  }
  return out;
}

}  // namespace

struct EngineBound::Impl : SizedSweeps {
  using SizedSweeps::SizedSweeps;
};

EngineBound::EngineBound(const PreparedScene& scene, double matrices, Attitude attitude)
    : impl_(new Impl(scene, matrices, attitude)) {}
EngineBound::~EngineBound() = default;

Eigen::MatrixXd EngineBound::operator()(Quantity quantity, const scene::State<double>& state) {
  return (*this)(quantity, runningErrorState(state));
}

Eigen::MatrixXd EngineBound::operator()(Quantity quantity,
                                        const scene::State<RunningError>& state) {
  const Rates zeros = impl_->setup.zeros();
  switch (quantity) {
    case Quantity::kM:
      return impl_->massMatrix(state);
    case Quantity::kc:
      return impl_->jointForces(state, state.qd, zeros, Terms::none());
    case Quantity::kg:
      return impl_->jointForces(state, zeros, zeros, Terms::potential());
    case Quantity::kTau:
      return impl_->jointForces(state, state.qd, state.qdd, Terms::all());
    case Quantity::kQdd:
      return impl_->accelerations(state);
    case Quantity::kReactions:
      impl_->run(state, state.qd, state.qdd, Terms::all());
      return impl_->reactions();
    case Quantity::kKinetic:
    case Quantity::kPotential:
    case Quantity::kMomentum:
      break;
  }
  impl_->run(state, state.qd, zeros, Terms::none());
  if (quantity == Quantity::kMomentum) return impl_->momentum();
  return scalar(quantity == Quantity::kKinetic ? impl_->kinetic(state.qd)
                                               : impl_->potential(state));
}

struct FrameJacobian::Impl : SizedSweeps {
  using SizedSweeps::SizedSweeps;
};

FrameJacobian::FrameJacobian(const PreparedScene& scene)
    : impl_(new Impl(scene, 1, Attitude::kQuaternion)) {}
FrameJacobian::~FrameJacobian() = default;

BoundedJacobian FrameJacobian::operator()(const FramePoint& point,
                                          const scene::State<double>& state) {
  return impl_->jacobian(point, runningErrorState(state));
}

}  // namespace dynwitness::crosscheck
