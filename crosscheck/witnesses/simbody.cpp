// SPDX-License-Identifier: GPL-3.0-or-later
// Simbody as a witness. Everything is built from the scene with Simbody's own transforms and
// inertia shifts, link by link, fixed joints as welds.
//
// This file is compiled with -UNDEBUG: Debian's Simbody 3.7 was, and its headers change the layout
// of its classes with that macro.
#include <Simbody.h>

#include <algorithm>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/engine_modules.hpp"
#include "crosscheck/witnesses/joint_friction.hpp"
#include "crosscheck/witnesses/mechanism_roads.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/outside_claims.hpp"
#include "crosscheck/witnesses/own_steps.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "recursive/constrained_solver.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::JointKind;
using scene::MassProperties;
using scene::RealNumbers;

SimTK::Vec3 vec3(const scene::Vector& v, const RealNumbers<double>& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

SimTK::Transform turn(double angle, const SimTK::CoordinateAxis& axis) {
  return SimTK::Transform(SimTK::Rotation(angle, axis));
}

SimTK::Transform composed(const std::vector<scene::Step>& steps,
                          const RealNumbers<double>& number) {
  using Kind = scene::Step::Kind;
  SimTK::Transform X;
  for (const scene::Step& step : steps) {
    switch (step.kind) {
      case Kind::kTranslate:
        X = X * SimTK::Transform(vec3(step.translation, number));
        break;
      case Kind::kRotateX:
        X = X * turn(number(step.angle), SimTK::XAxis);
        break;
      case Kind::kRotateY:
        X = X * turn(number(step.angle), SimTK::YAxis);
        break;
      case Kind::kRotateZ:
        X = X * turn(number(step.angle), SimTK::ZAxis);
        break;
    }
  }
  return X;
}

SimTK::MassProperties massProperties(const MassProperties& m, const RealNumbers<double>& number) {
  const double mass = number(m.mass);
  const SimTK::Vec3 com = vec3(m.com, number);
  const SimTK::Rotation R(SimTK::BodyRotationSequence, number(m.rpy[2]), SimTK::ZAxis,
                          number(m.rpy[1]), SimTK::YAxis, number(m.rpy[0]), SimTK::XAxis);
  SimTK::Inertia I(number(m.xx), number(m.yy), number(m.zz), number(m.xy), number(m.xz),
                   number(m.yz));
  I = I.reexpress(~R);
  if (m.about == MassProperties::About::kCenterOfMass && mass > 0)
    I = I.shiftFromMassCenter(-com, mass);
  return {mass, com, I};
}

/** A geared rotor is a body of its own, pinned to the ground (a gyroscopic one: to the parent link)
    and turning n times as fast as the joint: the same kinetic energy n^2 J qd^2 / 2, arrived at
    through another body. Forces on it reach the joint by virtual work. (A constraint in place of
    the virtual work was tried: its multipliers take the rotor off a tree that accelerates freely,
    and lost four digits of qdd on the PUMA 560.) */
struct Rotor {
  SimTK::MobilizedBody body;
  double gear_ratio;
  bool carried;  ///< by a link that moves
};

/// Whether a link rests in the world.
bool rests(const scene::Mechanism& mechanism, int link) {
  for (; link > 0; link = mechanism.links[link].parent)
    if (mechanism.links[link].joint.kind != JointKind::kFixed) return false;
  return true;
}

/// The frame on the parent whose z axis a joint's rotor turns about.
SimTK::Rotation rotorAxes(const scene::Joint& joint, const RealNumbers<double>& number) {
  return composed(joint.placement.beforeJoint(), number).R() *
         SimTK::Rotation(SimTK::UnitVec3(vec3(joint.axis, number)), SimTK::ZAxis);
}

/// The thinnest rotor with this inertia about its axis: a disc.
SimTK::Inertia disc(double J) {
  return {J / 2, J / 2, J};
}

/// Of a gyroscopic rotor: its spin counts, its weight is part of the link's. With 1e-100 kg no
/// digit feels it, while Simbody, which keeps inertias as multiples of the mass, can still hold J.
constexpr double kWeightless = 1e-100;

/** What is left of a link when the gyroscopic rotors that it carries are bodies of their own: the
    inertia less a disc each. Where on the link a rotor sits, and what it weighs, is part of the
    link's own figures; only its spin is not. What rests in the world needs no inertia, and keeps
    what it has. */
SimTK::MassProperties withoutDiscs(const scene::Mechanism& mechanism, int link,
                                   const RealNumbers<double>& number) {
  const SimTK::MassProperties whole = massProperties(mechanism.links[link].inertia, number);
  if (rests(mechanism, link)) return whole;
  SimTK::Inertia inertia = whole.calcInertia();
  for (const scene::Link& child : mechanism.links)
    if (child.parent == link && child.joint.gyroscopic)
      inertia -= disc(number(child.joint.rotor_inertia)).reexpress(~rotorAxes(child.joint, number));
  return {whole.getMass(), whole.getMassCenter(), inertia};
}

bool hasRotors(const scene::Mechanism& mechanism) {
  const RealNumbers<double> number(mechanism);
  return std::any_of(mechanism.links.begin(), mechanism.links.end(), [&](const scene::Link& link) {
    return number(link.joint.rotor_inertia) != 0;
  });
}

/** The axes in which Simbody's mobilizer moves, seen from the joint frame: a Pin, Screw and
    Cylinder about z, a Slider along x, a Planar in x and y about z; the others in the joint frame
    itself. */
SimTK::Transform axisFrame(const scene::Joint& joint, const RealNumbers<double>& number) {
  if (!scene::hasAxis(joint.kind)) return {};
  const SimTK::UnitVec3 axis(vec3(joint.axis, number));
  if (joint.kind == JointKind::kPlanar) {  // Rz(alpha) Ry(beta) takes z to the axis
    const double rho = std::hypot(axis[0], axis[1]);
    return SimTK::Transform(SimTK::Rotation(SimTK::BodyRotationSequence,
                                            rho == 0 ? 0 : std::atan2(axis[1], axis[0]),
                                            SimTK::ZAxis, std::atan2(rho, axis[2]), SimTK::YAxis));
  }
  return SimTK::Transform(SimTK::Rotation(axis, joint.kind == JointKind::kPrismatic
                                                    ? SimTK::CoordinateAxis(SimTK::XAxis)
                                                    : SimTK::CoordinateAxis(SimTK::ZAxis)));
}

SimTK::MobilizedBody mobilizer(JointKind kind, double pitch, SimTK::MobilizedBody& parent,
                               const SimTK::Transform& X_PF, const SimTK::Body::Rigid& body,
                               const SimTK::Transform& X_BM) {
  using SimTK::MobilizedBody;
  switch (kind) {
    case JointKind::kFixed:
      return MobilizedBody::Weld(parent, X_PF, body, X_BM);
    case JointKind::kRevolute:
      return MobilizedBody::Pin(parent, X_PF, body, X_BM);
    case JointKind::kPrismatic:
      return MobilizedBody::Slider(parent, X_PF, body, X_BM);
    case JointKind::kHelical:
      return MobilizedBody::Screw(parent, X_PF, body, X_BM, pitch);
    case JointKind::kCylindrical:
      return MobilizedBody::Cylinder(parent, X_PF, body, X_BM);
    case JointKind::kUniversal:
      return MobilizedBody::Universal(parent, X_PF, body, X_BM);
    case JointKind::kPlanar:
      return MobilizedBody::Planar(parent, X_PF, body, X_BM);
    case JointKind::kSpherical:
      return MobilizedBody::Ball(parent, X_PF, body, X_BM);
    case JointKind::kFloating:
      return MobilizedBody::Free(parent, X_PF, body, X_BM);
  }
  throw std::logic_error("simbody: unknown joint kind");
}

/** A joint of the scene, and how Simbody's generalised speeds u follow from its rates qd.

        u = E qd,   du/dt = E qdd + b,   generalised forces of qd = E' (those of u)

    E permutes the rates of Cylinder (turn, slide) and Planar (turn, x, y). A Ball's u is the
    angular velocity, a Free's the angular velocity and then the velocity of the origin, both in the
    axes of the unmoved joint frame; the scene's are in those of the moved one. With R the
    orientation, d(R w)/dt = R (dw/dt + w x w) = R dw/dt, but d(R v)/dt = R (dv/dt + w x v): b has R
    (w x v). */
struct Joint {
  SimTK::MobilizedBody body;
  JointKind kind;
  int slot, dof;  ///< its first position and rate in the scene's order

  int rates() const { return scene::degreesOfFreedom(kind); }
  bool turnsRates() const { return !scene::ratesArePositionDerivatives(kind); }

  /// Where Simbody has the scene's coordinate k.
  int place(int k) const {
    if (kind == JointKind::kCylindrical) return 1 - k;
    if (kind == JointKind::kPlanar) return (k + 1) % 3;
    if (kind == JointKind::kFloating) return k < 3 ? 3 + k : k - 3;  // angular part first
    return k;
  }

  void setPosition(SimTK::State& state, const std::vector<scene::JointPosition<double>>& x) const {
    if (!turnsRates()) {
      for (int k = 0; k < rates(); ++k) body.setOneQ(state, place(k), x[slot + k].q);
      return;
    }
    int first = slot;
    if (kind == JointKind::kFloating) {  // quaternion first
      for (int k = 0; k < 3; ++k) body.setOneQ(state, 4 + k, x[slot + k].q);
      first += 3;
    }
    const SimTK::Quaternion unit(
        SimTK::Vec4(x[first].q, x[first + 1].q, x[first + 2].q, x[first + 3].q));
    for (int k = 0; k < 4; ++k) body.setOneQ(state, k, unit[k]);
  }

  /// R of the unit quaternion that Simbody was given.
  SimTK::Rotation orientation(const SimTK::State& state) const {
    return SimTK::Rotation(
        SimTK::Quaternion(SimTK::Vec4(body.getOneQ(state, 0), body.getOneQ(state, 1),
                                      body.getOneQ(state, 2), body.getOneQ(state, 3))));
  }

  /// E x, to where the joint's speeds are in `u`.
  template <typename Rates>
  void expand(const SimTK::State& state, const Rates& x, SimTK::Vector* u) const {
    const int first = body.getFirstUIndex(state);
    for (int k = 0; k < rates(); ++k) (*u)[first + place(k)] = x[dof + k];
    if (!turnsRates()) return;
    const SimTK::Rotation R = orientation(state);
    for (int part = 0; part < rates(); part += 3) turn(R, u, first + part);
  }
  /// E' f, to where the joint's forces are in `out`.
  void reduce(const SimTK::State& state, SimTK::Vector f, Eigen::VectorXd* out) const {
    const int first = body.getFirstUIndex(state);
    if (turnsRates()) {
      const SimTK::Rotation R = orientation(state);
      for (int part = 0; part < rates(); part += 3) turn(~R, &f, first + part);
    }
    for (int k = 0; k < rates(); ++k) (*out)(dof + k) = f[first + place(k)];
  }
  /// b, for the speeds that the state has; its other entries are zero.
  SimTK::Vec3 bias(const SimTK::State& state) const {
    const SimTK::Vec3 w(body.getOneU(state, 0), body.getOneU(state, 1), body.getOneU(state, 2));
    const SimTK::Vec3 v(body.getOneU(state, 3), body.getOneU(state, 4), body.getOneU(state, 5));
    return w % v;  // R (w x v) = (R w) x (R v)
  }

 private:
  static void turn(const SimTK::Mat33& R, SimTK::Vector* u, int at) {
    const SimTK::Vec3 turned = R * SimTK::Vec3((*u)[at], (*u)[at + 1], (*u)[at + 2]);
    for (int k = 0; k < 3; ++k) (*u)[at + k] = turned[k];
  }
};

class SimbodyWitness : public Witness, public OwnSteps, public OutsideClaims {
 public:
  /// kTree: the tree alone, for all questions; kClosed: with the scene's closures, springs between
  /// points and driven joints, for qdd and what constraints and drives do; kPrescribed: the tree
  /// with its accelerations prescribed, for reactions.
  enum class Build { kTree, kClosed, kPrescribed };
  explicit SimbodyWitness(const PreparedScene& scene, Build build = Build::kTree)
      : scene_(scene),
        build_(build),
        friction_(scene.mechanism(), JointFriction::Parts::kCoulomb),
        has_rotors_(hasRotors(scene.mechanism())),
        bound_(scene),
        solve_bound_(scene, has_rotors_ ? SolvedBy::kMassMatrix : SolvedBy::kSweep, kEngineTurns),
        matter_(system_),
        forces_(system_),
        loads_(forces_, matter_) {
    const scene::Mechanism& mechanism = scene.mechanism();
    const RealNumbers<double> number(mechanism);
    if (mechanism.has_gravity)
      SimTK::Force::Gravity(forces_, matter_, vec3(mechanism.gravity, number));
    for (std::size_t i = 0; i < mechanism.links.size(); ++i) addLink(mechanism, i, number);
    for (const scene::Wrench& w : mechanism.wrenches)
      wrenches_.push_back({w.link, w.axes == scene::Wrench::Axes::kWorld, vec3(w.force, number),
                           vec3(w.moment, number), vec3(w.at, number)});
    if (build == Build::kClosed) {
      requireBuilt(mechanism);
      for (const scene::Closure& closure : mechanism.closures) addClosure(closure, number);
      for (const scene::Spring& spring : mechanism.springs) addSpring(spring, number);
      for (const std::size_t joint : driven_) Prescribed(joints_[joint].body, &prescribed_);
    }
    if (build == Build::kPrescribed) {
      for (Joint& joint : joints_) Prescribed(joint.body, &prescribed_);
      for (Rotor& rotor : rotors_)
        if (!rotor.body.isEmptyHandle()) Prescribed(rotor.body, &prescribed_);
    }
    state_ = system_.realizeTopology();
    system_.realizeModel(state_);
  }

  const std::string& name() const override { return name_; }
  bool answers(Quantity) const override { return true; }

  bool knowsJacobian() const override { return true; }
  /// By calcFrameJacobian of a frame at the point, angular part first as Simbody has it.
  std::vector<SaidJacobian> jacobians(const FramePoint& point,
                                      const std::vector<scene::State<double>>& states) override {
    std::vector<SaidJacobian> out;
    for (const scene::State<double>& state : states) {
      setMotion(state, false);
      system_.realize(state_, SimTK::Stage::Position);
      SimTK::Matrix full;
      matter_.calcFrameJacobian(state_, links_[static_cast<std::size_t>(point.link)],
                                {point.at(0), point.at(1), point.at(2)}, full);
      Eigen::MatrixXd J(6, dof_);
      for (int j = 0; j < dof_; ++j) {
        std::vector<double> unit(static_cast<std::size_t>(dof_), 0.0);
        unit[static_cast<std::size_t>(j)] = 1;
        const SimTK::Vector column = full * expanded(unit);
        for (int i = 0; i < 6; ++i) J(i, j) = column[(i + 3) % 6];
      }
      out.push_back({J, {}});
    }
    return out;
  }

  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out{value(quantity, state), bound_(quantity, state)};
    if (quantity == Quantity::kQdd)
      solve_bound_.judge(state, bound_(Quantity::kTau, moving(state, out.value)), out);
    return out;
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    if (quantity == Quantity::kReactions && build_ != Build::kPrescribed) {
      if (!of_reactions_)
        of_reactions_ = std::make_unique<SimbodyWitness>(scene_, Build::kPrescribed);
      return of_reactions_->value(quantity, state);
    }
    return friction_.around(quantity, state, [&](const scene::State<double>& without_coulomb) {
      return ofSimbody(quantity, without_coulomb);
    });
  }

  /// By its Runge, Kutta and Merson's method, in equal steps.
  OwnMotion ownMotion(const scene::State<double>& start, double step, long steps,
                      long every) override {
    if (has_rotors_) throw std::runtime_error("Simbody has no rotors: each is a body apart here");
    for (const Joint& joint : joints_)
      if (joint.turnsRates())
        throw std::runtime_error("joints with quaternions are not moved by its own steps here");
    loads_.clearAllForces(state_);
    setMotion(start, true);
    state_.setTime(0);
    SimTK::RungeKuttaMersonIntegrator integrator(system_);
    integrator.setFixedStepSize(step);
    SimTK::TimeStepper stepper(system_, integrator);
    stepper.initialize(state_);
    OwnMotion out;
    out.by = fmt::format("simbody, Runge-Kutta-Merson, steps of {} s", step);
    for (long k = 0;; k += every) {
      if (k > 0) stepper.stepTo(static_cast<double>(k) * step);
      const SimTK::State& now = integrator.getState();
      system_.realize(now, SimTK::Stage::Acceleration);
      OwnMotion::Moment moment{now.getTime(), {}, {}, {}};
      for (const Joint& joint : joints_)
        for (int i = 0; i < joint.rates(); ++i) {
          moment.q.push_back(joint.body.getOneQ(now, joint.place(i)));
          moment.qd.push_back(joint.body.getOneU(now, joint.place(i)));
          moment.qdd.push_back(joint.body.getOneUDot(now, joint.place(i)));
        }
      out.moments.push_back(std::move(moment));
      if (k + every > steps) break;
    }
    return out;
  }

  /// Of kClosed: in the order of kMechanismQuantities, lambda and nu empty.
  std::array<Eigen::VectorXd, std::size(kMechanismQuantities)> mechanism(
      const scene::State<double>& state) {
    loads_.clearAllForces(state_);
    setMotion(state, true);
    applyLoads();
    std::array<Eigen::VectorXd, std::size(kMechanismQuantities)> out;
    const auto part = [&out](MechanismQuantity quantity) -> Eigen::VectorXd& {
      return out[static_cast<std::size_t>(quantity)];
    };
    if (has_rotors_) {
      solveWithRotors(state.tau, part(MechanismQuantity::kQdd),
                      part(MechanismQuantity::kConstraintForce));
      return out;
    }
    prescribed_ = speedRates(state.qdd);
    part(MechanismQuantity::kQdd) = accelerations(state.tau);
    // M du/dt + G' lambda + (drives) = f: both are on the side of inertia
    SimTK::Vector force;
    matter_.multiplyByGTranspose(state_, state_.getMultipliers(), force);
    part(MechanismQuantity::kConstraintForce) = -reduced(force);
    matter_.findMotionForces(state_, force);
    const Eigen::VectorXd of_motions = -reduced(force);
    Eigen::VectorXd& drive = part(MechanismQuantity::kDrive);
    for (const std::size_t joint : driven_)
      for (int k = 0; k < joints_[joint].rates(); ++k) {
        drive.conservativeResize(drive.size() + 1);
        drive(drive.size() - 1) = of_motions(joints_[joint].dof + k);
      }
    part(MechanismQuantity::kReactions) = transmitted();
    return out;
  }

 private:
  struct AppliedWrench {
    int link;
    bool world_axes;
    SimTK::Vec3 force, moment, at;
  };

  /// A mobilizer that accelerates as it is told: *u_rate holds du/dt of the whole system.
  class Prescribed : public SimTK::Motion::Custom {
   public:
    Prescribed(SimTK::MobilizedBody& body, const SimTK::Vector* u_rate)
        : Custom(body, new Motion(body, u_rate)) {}

   private:
    class Motion : public Implementation {
     public:
      Motion(const SimTK::MobilizedBody& body, const SimTK::Vector* u_rate)
          : body_(body), u_rate_(u_rate) {}
      SimTK::Motion::Level getLevel(const SimTK::State&) const override {
        return SimTK::Motion::Acceleration;
      }
      void calcPrescribedAcceleration(const SimTK::State& state, int nu,
                                      SimTK::Real* u_rate) const override {
        const int first = body_.getFirstUIndex(state);
        for (int k = 0; k < nu; ++k) u_rate[k] = (*u_rate_)[first + k];
      }

     private:
      SimTK::MobilizedBody body_;
      const SimTK::Vector* u_rate_;
    };
  };

  Eigen::MatrixXd ofSimbody(Quantity quantity, const scene::State<double>& state) {
    // c and g are asked without the loads, tau and qdd with them
    const bool loaded = quantity == Quantity::kTau || quantity == Quantity::kQdd ||
                        quantity == Quantity::kReactions;
    loads_.clearAllForces(state_);
    setMotion(state, quantity != Quantity::kg);
    if (loaded) applyLoads();
    switch (quantity) {
      case Quantity::kM:
        return massMatrix();
      case Quantity::kc:
        return residual({}, false);
      case Quantity::kg:
        return residual({}, true);
      case Quantity::kTau:
        return residual(state.qdd, true);
      case Quantity::kQdd:
        if (build_ == Build::kClosed) prescribed_ = speedRates(state.qdd);
        return accelerations(state.tau);
      case Quantity::kKinetic:
        system_.realize(state_, SimTK::Stage::Velocity);
        return Eigen::MatrixXd::Constant(1, 1, system_.calcKineticEnergy(state_));
      case Quantity::kPotential:
        system_.realize(state_, SimTK::Stage::Dynamics);
        return Eigen::MatrixXd::Constant(1, 1, system_.calcPotentialEnergy(state_));
      case Quantity::kMomentum:
        return momentum();
      case Quantity::kReactions:
        return reactions(state.qdd);
    }
    throw std::logic_error("simbody: not answered");
  }

  void addLink(const scene::Mechanism& mechanism, std::size_t index,
               const RealNumbers<double>& number) {
    const scene::Link& link = mechanism.links[index];
    const scene::Joint& joint = link.joint;
    SimTK::MobilizedBody& parent =
        link.parent < 0 ? matter_.updGround() : matter_.updMobilizedBody(links_[link.parent]);
    const SimTK::Body::Rigid body(withoutDiscs(mechanism, static_cast<int>(index), number));
    const SimTK::Transform X_before = composed(joint.placement.beforeJoint(), number);
    const SimTK::Transform X_after = composed(joint.placement.afterJoint(), number);
    if (joint.kind == JointKind::kFixed) {
      links_.push_back(
          SimTK::MobilizedBody::Weld(parent, X_before, body, ~X_after).getMobilizedBodyIndex());
      return;
    }
    const SimTK::Transform X_axis = axisFrame(joint, number);
    const SimTK::Transform X_PF = X_before * X_axis, X_BM = ~X_after * X_axis;
    const SimTK::MobilizedBody moved =
        mobilizer(joint.kind, number(joint.pitch), parent, X_PF, body, X_BM);
    links_.push_back(moved.getMobilizedBodyIndex());
    if (!joint.motion.empty()) driven_.push_back(joints_.size());
    joints_.push_back({moved, joint.kind, slots_, dof_});
    slots_ += static_cast<int>(scene::positionSlots(joint.kind).size());
    dof_ += scene::degreesOfFreedom(joint.kind);
    const double stiffness = number(joint.stiffness);
    if (stiffness != 0)
      SimTK::Force::MobilityLinearSpring(forces_, moved, SimTK::MobilizerQIndex(0), stiffness,
                                         number(joint.rest));
    const double viscous = number(joint.friction.viscous);
    if (viscous != 0)
      SimTK::Force::MobilityLinearDamper(forces_, moved, SimTK::MobilizerUIndex(0), viscous);
    rotors_.emplace_back();
    const double rotor = number(joint.rotor_inertia), gear = number(joint.gear_ratio);
    if (rotor == 0) return;
    if (joint.gyroscopic && link.parent > 0) {  // the root has no joint that would feel it
      const SimTK::MobilizedBody::Pin spinning(
          parent, SimTK::Transform(rotorAxes(joint, number)),
          SimTK::Body::Rigid(SimTK::MassProperties(kWeightless, SimTK::Vec3(0), disc(rotor))),
          SimTK::Transform());
      rotors_.back() = {spinning, gear, !rests(mechanism, link.parent)};
    } else {
      addRotor(rotor, gear);
    }
  }

  /// What kClosed has no words for.
  void requireBuilt(const scene::Mechanism& mechanism) const {
    if (!mechanism.acceleration_constraints.empty())
      throw std::invalid_argument(
          "Simbody has no constraint on the acceleration of a link alone, and none is built here");
    if (mechanism.hasCoulombFriction())
      throw std::invalid_argument("Coulomb's friction is not built beside Simbody's constraints");
    if (has_rotors_ && !driven_.empty())
      throw std::invalid_argument("rotors and driven joints together are not built");
  }

  /// Rotors turn with their joints: M, G, bias and gamma are Simbody's, and the system is solved
  /// here.
  void solveWithRotors(const std::vector<double>& tau, Eigen::VectorXd& qdd,
                       Eigen::VectorXd& force) {
    const Eigen::VectorXd bias = residual({}, true);
    SimTK::Matrix G;
    SimTK::Vector at_rest;
    matter_.calcG(state_, G);
    matter_.calcBiasForAccelerationConstraints(state_, at_rest);
    at_rest += G * speedRates({});
    Eigen::MatrixXd J_transposed(dof_, G.nrow());
    Eigen::VectorXd gamma(G.nrow());
    for (int row = 0; row < G.nrow(); ++row) {
      J_transposed.col(row) = reduced(SimTK::Vector(~G.row(row)));
      gamma(row) = at_rest[row];
    }
    recursive::ConstrainedSolver<double> solver;
    solver.factorize(massMatrix(), J_transposed.transpose());
    const auto solved = solver.solve(Eigen::Map<const Eigen::VectorXd>(tau.data(), dof_) - bias,
                                     Eigen::VectorXd(-gamma));
    qdd = solved.qdd;
    force = J_transposed * solved.lambda;
  }

  void addClosure(const scene::Closure& closure, const RealNumbers<double>& number) {
    using namespace SimTK;  // NOLINT(google-build-using-namespace): its constraints, five of them
    MobilizedBody& a = matter_.updMobilizedBody(links_[closure.a.link]);
    MobilizedBody& b = matter_.updMobilizedBody(links_[closure.b.link]);
    const SimTK::Transform X_A = composed(closure.a.steps(), number),
                           X_B = composed(closure.b.steps(), number);
    switch (closure.kind) {
      case scene::ClosureKind::kDistance:
        Constraint::Rod(a, X_A.p(), b, X_B.p(), number(closure.length));
        break;
      case scene::ClosureKind::kPlane:
        Constraint::PointInPlane(a, X_A.z(), dot(X_A.z(), X_A.p()), b, X_B.p());
        break;
      case scene::ClosureKind::kPlanarPoint:
        Constraint::PointOnLine(a, X_A.z(), X_A.p(), b, X_B.p());
        break;
      case scene::ClosureKind::kPoint:
        Constraint::Ball(a, X_A.p(), b, X_B.p());
        break;
      case scene::ClosureKind::kHinge:
        Constraint::Ball(a, X_A.p(), b, X_B.p());
        Constraint::ConstantAngle(a, X_A.x(), b, X_B.z(), Pi / 2);
        Constraint::ConstantAngle(a, X_A.y(), b, X_B.z(), Pi / 2);
        break;
      case scene::ClosureKind::kWeld:
        Constraint::Weld(a, X_A, b, X_B);
        break;
      case scene::ClosureKind::kSkate:  // material points of a and of b, at b's origin
        // where a turns, what it asks of accelerations is not the derivative of what it asks of
        // rates: random mechanisms show it against Lagrange's equations, which differentiate
        if (!rests(scene_.mechanism(), closure.a.link))
          throw std::invalid_argument(
              "simbody: NoSlip1D over a link that itself moves (the closure's a) loses a part of "
              "the acceleration");
        Constraint::NoSlip1D(b, X_B.p(), UnitVec3(X_B.y()), a, b);
        break;
      case scene::ClosureKind::kRolling:
        throw std::invalid_argument(
            "simbody: it has no constraint for a disc that leans and rolls");
    }
  }

  void addSpring(const scene::Spring& spring, const RealNumbers<double>& number) {
    const SimTK::MobilizedBody& a = matter_.getMobilizedBody(links_[spring.a.link]);
    const SimTK::MobilizedBody& b = matter_.getMobilizedBody(links_[spring.b.link]);
    const SimTK::Vec3 at_a = vec3(spring.a.xyz, number), at_b = vec3(spring.b.xyz, number);
    SimTK::Force::TwoPointLinearSpring(forces_, a, at_a, b, at_b, number(spring.stiffness),
                                       number(spring.rest));
    SimTK::Force::TwoPointLinearDamper(forces_, a, at_a, b, at_b, number(spring.damping));
  }

  void addRotor(double inertia, double gear) {
    // mass and the other moments of inertia do nothing: the body turns about an axis through its
    // centre of mass that rests in the world
    const SimTK::Body::Rigid body(
        SimTK::MassProperties(1, SimTK::Vec3(0), SimTK::Inertia(inertia, inertia, inertia)));
    const SimTK::MobilizedBody::Pin rotor(matter_.updGround(), body);
    rotors_.back() = {rotor, gear, false};
  }

  bool hasRotor(std::size_t i) const { return !rotors_[i].body.isEmptyHandle(); }

  void setMotion(const scene::State<double>& state, bool moving) {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      joints_[i].setPosition(state_, state.x);
      if (hasRotor(i))
        rotors_[i].body.setOneQ(state_, 0, rotors_[i].gear_ratio * state.x[joints_[i].slot].q);
    }
    state_.updU() = expanded(moving ? state.qd : std::vector<double>(dof_, 0.0));
  }

  void applyLoads() {
    system_.realize(state_, SimTK::Stage::Position);
    for (const AppliedWrench& w : wrenches_) {
      const SimTK::MobilizedBody& body = matter_.getMobilizedBody(links_[w.link]);
      const SimTK::Rotation& R = body.getBodyRotation(state_);
      const SimTK::Vec3 force = w.world_axes ? w.force : R * w.force;
      const SimTK::Vec3 moment = w.world_axes ? w.moment : R * w.moment;
      // Simbody's spatial vectors put the moment first, taken about the body origin in ground axes
      const SimTK::SpatialVec wrench(moment + (R * w.at) % force, force);
      loads_.setOneBodyForce(state_, body, loads_.getOneBodyForce(state_, body) + wrench);
    }
  }

  /// Mobility space is (joints, rotors); a joint's generalised force is its own plus n times its
  /// rotor's.
  Eigen::VectorXd reduced(const SimTK::Vector& mobility_forces) const {
    Eigen::VectorXd out(dof_);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      joints_[i].reduce(state_, mobility_forces, &out);
      if (hasRotor(i))
        out(joints_[i].dof) += rotors_[i].gear_ratio * mobility_forces[uIndex(rotors_[i].body)];
    }
    return out;
  }
  template <typename Rates>
  SimTK::Vector expanded(const Rates& joint_rates) const {
    SimTK::Vector out(state_.getNU(), 0.0);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      joints_[i].expand(state_, joint_rates, &out);
      if (hasRotor(i))
        out[uIndex(rotors_[i].body)] = rotors_[i].gear_ratio * joint_rates[joints_[i].dof];
    }
    return out;
  }
  /// du/dt at accelerations qdd (none: zero) and the speeds of the state.
  SimTK::Vector speedRates(const std::vector<double>& qdd) const {
    SimTK::Vector out = expanded(qdd.empty() ? std::vector<double>(dof_, 0.0) : qdd);
    for (const Joint& joint : joints_) {
      if (joint.kind != JointKind::kFloating) continue;
      const SimTK::Vec3 b = joint.bias(state_);
      for (int k = 0; k < 3; ++k) out[uIndex(joint.body) + 3 + k] += b[k];
    }
    return out;
  }
  int uIndex(const SimTK::MobilizedBody& body) const { return body.getFirstUIndex(state_); }

  Eigen::MatrixXd massMatrix() {
    system_.realize(state_, SimTK::Stage::Position);
    const int n = dof_;
    Eigen::MatrixXd M(n, n);
    SimTK::Matrix full;
    matter_.calcM(state_, full);
    for (int j = 0; j < n; ++j) {
      std::vector<double> unit(n, 0.0);
      unit[j] = 1;
      M.col(j) = reduced(full * expanded(unit));
    }
    return M;
  }

  /// M qdd + c - (applied forces), by Simbody's inverse dynamics.
  Eigen::VectorXd residual(const std::vector<double>& qdd, bool with_applied_forces) {
    system_.realize(state_, SimTK::Stage::Dynamics);
    SimTK::Vector mobility_forces;
    SimTK::Vector_<SimTK::SpatialVec> body_forces;
    if (with_applied_forces) {
      mobility_forces = system_.getMobilityForces(state_, SimTK::Stage::Dynamics);
      body_forces = system_.getRigidBodyForces(state_, SimTK::Stage::Dynamics);
    }
    SimTK::Vector out;
    matter_.calcResidualForceIgnoringConstraints(state_, mobility_forces, body_forces,
                                                 speedRates(qdd), out);
    return reduced(out);
  }

  Eigen::VectorXd accelerations(const std::vector<double>& tau) {
    if (has_rotors_) {  // Simbody's M and bias with the rotors, solved here
      const Eigen::VectorXd bias = residual({}, true);
      return massMatrix().ldlt().solve(Eigen::Map<const Eigen::VectorXd>(tau.data(), tau.size()) -
                                       bias);
    }
    // forces of u = E qd: tau = E' f, and E is a rotation or a permutation
    const SimTK::Vector f = expanded(tau);
    for (const Joint& joint : joints_)
      for (int k = 0; k < joint.rates(); ++k)
        loads_.setOneMobilityForce(state_, joint.body, SimTK::MobilizerUIndex(k),
                                   f[uIndex(joint.body) + k]);
    system_.realize(state_, SimTK::Stage::Acceleration);
    SimTK::Vector u_rate = state_.getUDot();
    u_rate -= speedRates({});
    return reduced(u_rate);  // E' = E^-1
  }

  /// Simbody's forces on each body at its M frame, which is the moved joint frame up to a turn, in
  /// ground axes, moment first.
  Eigen::VectorXd reactions(const std::vector<double>& qdd) {
    prescribed_ = speedRates(qdd);
    system_.realize(state_, SimTK::Stage::Acceleration);
    return transmitted();
  }
  /// The same of what accelerations were realized.
  Eigen::VectorXd transmitted() const {
    SimTK::Vector_<SimTK::SpatialVec> at_M;
    matter_.calcMobilizerReactionForces(state_, at_M);
    const RealNumbers<double> number(scene_.mechanism());
    Eigen::VectorXd out(6 * (links_.size() - 1));
    for (std::size_t i = 1; i < links_.size(); ++i) {
      const SimTK::Rotation R_BJ =
          ~composed(scene_.mechanism().links[i].joint.placement.afterJoint(), number).R();
      const SimTK::Rotation R_GJ =
          matter_.getMobilizedBody(links_[i]).getBodyRotation(state_) * R_BJ;
      const SimTK::Vec3 force = ~R_GJ * at_M[links_[i]][1], moment = ~R_GJ * at_M[links_[i]][0];
      for (int k = 0; k < 3; ++k) {
        out(6 * (i - 1) + k) = force[k];
        out(6 * (i - 1) + 3 + k) = moment[k];
      }
    }
    return out;
  }

  Eigen::VectorXd momentum() {
    system_.realize(state_, SimTK::Stage::Velocity);
    SimTK::Vec3 linear(0), angular(0);
    std::vector<SimTK::MobilizedBodyIndex> bodies = links_;
    for (const Rotor& rotor : rotors_)
      if (!rotor.body.isEmptyHandle() && rotor.carried)
        bodies.push_back(rotor.body.getMobilizedBodyIndex());
    for (const SimTK::MobilizedBodyIndex& link : bodies) {
      SimTK::MobilizedBody& body = matter_.updMobilizedBody(link);
      const SimTK::SpatialVec h = body.calcBodyMomentumAboutBodyOriginInGround(state_);
      linear += h[1];
      angular += h[0] + body.getBodyOriginLocation(state_) % h[1];
    }
    Eigen::VectorXd out(6);
    out << linear[0], linear[1], linear[2], angular[0], angular[1], angular[2];
    return out;
  }

  std::string name_ = "simbody";
  PreparedScene scene_;
  Build build_;
  JointFriction friction_;
  std::unique_ptr<SimbodyWitness> of_reactions_;  ///< made when it is asked for the first time
  SimTK::Vector prescribed_;                      ///< du/dt, kPrescribed
  bool has_rotors_;
  EngineBound bound_;
  SolveBound solve_bound_;
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::DiscreteForces loads_;
  std::vector<SimTK::MobilizedBodyIndex> links_;  ///< one a scene link
  std::vector<Joint> joints_;                     ///< one a joint that moves
  std::vector<std::size_t> driven_;               ///< of these
  std::vector<Rotor> rotors_;                     ///< one a joint, empty without rotor
  int slots_ = 0, dof_ = 0;
  std::vector<AppliedWrench> wrenches_;
  SimTK::State state_;
};

constexpr const char* kConventions =
    "reads: the scene, placed with Simbody's own Rotation and Transform, inertias turned and "
    "shifted "
    "by its Inertia; fixed joints are welds\n"
    "spatial vectors: angular part first, ground axes, about the body's origin\n"
    "joint axis: a Pin, Screw or Cylinder about z, a Slider along x, a Planar in x and y, a "
    "Universal "
    "about x and the new y of its frame\n"
    "speeds: those of Ball and Free are turned from the scene's moved joint frame to the unmoved "
    "one; a "
    "Free's dv/dt has w x v besides\n"
    "inertia: given about the centre of mass, kept about the body's origin\n"
    "bias: c is the residual force of inverse dynamics without applied forces and accelerations; g "
    "is that of the applied forces at rest\n"
    "gravity: Force::Gravity takes the acceleration of a falling body, as in the scene\n"
    "springs: MobilityLinearSpring, an applied force\n"
    "friction: viscous by MobilityLinearDamper, an applied force; Coulomb's is added here\n"
    "reactions: calcMobilizerReactionForces of a second system whose accelerations are prescribed\n"
    "rotors: each is a body pinned to the ground that turns gear_ratio times as fast; then M and "
    "bias are Simbody's, and M qdd = tau - bias is solved here; a gyroscopic one is pinned to the "
    "parent, and its disc taken off the parent's inertia\n"
    "loads: body forces about the body's origin, ground axes\n"
    "known loss: none";

std::string simbodyVersion() {
  int major = 0, minor = 0, build = 0;
  SimTK_version_simbody(&major, &minor, &build);
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(build);
}

Eigen::VectorXd closedAccelerations(const scene::Scene& scene, const scene::State<double>& state) {
  scene::requireNoMimics({scene.file.string(), 0}, scene.mechanism,
                         "Simbody's closed system has none");
  if (hasRotors(scene.mechanism))
    throw std::invalid_argument("simbody: rotors and closures together are not answered");
  return SimbodyWitness(scene, SimbodyWitness::Build::kClosed).value(Quantity::kQdd, state);
}

SimbodyMechanism mechanismOf(const PreparedScene& scene) {
  scene::requireNoMimics({scene.scene().file.string(), 0}, scene.mechanism(),
                         "Simbody's closed system has none");
  const auto closed = std::make_shared<SimbodyWitness>(scene, SimbodyWitness::Build::kClosed);
  return [closed](const scene::State<double>& state) { return closed->mechanism(state); };
}

std::vector<WitnessKind> kinds() {
  WitnessInfo info;
  info.name = kSimbody.name;
  info.version = simbodyVersion();
  info.method = kSimbody.method;
  info.conventions = kConventions;
  return {overTree(engineKind<SimbodyWitness>(info))};
}

}  // namespace
}  // namespace dynwitness::crosscheck

const dynwitness::crosscheck::EngineModule dynwitness_engine = {
    DYNWITNESS_VERSION, dynwitness::crosscheck::kinds, dynwitness::crosscheck::mechanismOf,
    dynwitness::crosscheck::closedAccelerations, nullptr};
