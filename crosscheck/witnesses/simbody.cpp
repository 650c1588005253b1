// SPDX-License-Identifier: GPL-3.0-or-later
// Simbody as a witness. Everything is built from the scene with Simbody's own transforms and inertia
// shifts, link by link, fixed joints as welds.
//
// This file is compiled with -UNDEBUG: Debian's Simbody 3.7 was, and its headers change the layout of
// its classes with that macro.
#include <Simbody.h>

#include <algorithm>

#include <Eigen/Cholesky>

#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
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

SimTK::Transform composed(const std::vector<scene::Step>& steps, const RealNumbers<double>& number) {
  using Kind = scene::Step::Kind;
  SimTK::Transform X;
  for (const scene::Step& step : steps) {
    switch (step.kind) {
      case Kind::kTranslate: X = X * SimTK::Transform(vec3(step.translation, number)); break;
      case Kind::kRotateX: X = X * turn(number(step.angle), SimTK::XAxis); break;
      case Kind::kRotateY: X = X * turn(number(step.angle), SimTK::YAxis); break;
      case Kind::kRotateZ: X = X * turn(number(step.angle), SimTK::ZAxis); break;
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

/** A geared rotor is a body of its own, pinned to the ground and turning n times as fast as the joint:
    the same kinetic energy n^2 J qd^2 / 2, arrived at through another body. Forces on it reach the
    joint by virtual work. (A constraint in place of the virtual work was tried: its multipliers take
    the rotor off a tree that accelerates freely, and lost four digits of qdd on the PUMA 560.) */
struct Rotor {
  SimTK::MobilizedBody body;
  double gear_ratio;
};

bool hasRotors(const scene::Mechanism& mechanism) {
  const RealNumbers<double> number(mechanism);
  return std::any_of(mechanism.links.begin(), mechanism.links.end(), [&](const scene::Link& link) {
    return number(link.joint.rotor_inertia) != 0;
  });
}

class SimbodyWitness : public Witness {
 public:
  /// @param closed  with the scene's closures and springs between points: for qdd only
  explicit SimbodyWitness(const scene::Scene& scene, bool closed = false)
      : has_rotors_(hasRotors(scene.mechanism)),
        bound_(scene.mechanism,
               has_rotors_ ? ForwardDynamicsBy::kMassMatrix : ForwardDynamicsBy::kSweep),
        matter_(system_),
        forces_(system_),
        loads_(forces_, matter_) {
    const scene::Mechanism& mechanism = scene.mechanism;
    const RealNumbers<double> number(mechanism);
    if (mechanism.has_gravity)
      SimTK::Force::Gravity(forces_, matter_, vec3(mechanism.gravity, number));
    for (const scene::Link& link : mechanism.links) addLink(link, number);
    for (const scene::Wrench& w : mechanism.wrenches)
      wrenches_.push_back({w.link, w.axes == scene::Wrench::Axes::kWorld, vec3(w.force, number),
                           vec3(w.moment, number), vec3(w.at, number)});
    if (closed) {
      if (has_rotors_)
        throw std::invalid_argument("simbody: rotors and closures together are not answered");
      for (const scene::Closure& closure : mechanism.closures) addClosure(closure, number);
      for (const scene::Spring& spring : mechanism.springs) addSpring(spring, number);
    }
    state_ = system_.realizeTopology();
    system_.realizeModel(state_);
  }

  const std::string& name() const override { return name_; }
  bool answers(Quantity) const override { return true; }

  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    return {value(quantity, state), bound_(quantity, state)};
  }
  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    // c and g are asked without the loads, tau and qdd with them
    const bool loaded = quantity == Quantity::kTau || quantity == Quantity::kQdd;
    loads_.clearAllForces(state_);
    setMotion(state, quantity != Quantity::kg);
    if (loaded) applyLoads();
    switch (quantity) {
      case Quantity::kM: return massMatrix();
      case Quantity::kc: return residual({}, false);
      case Quantity::kg: return residual({}, true);
      case Quantity::kTau: return residual(state.qdd, true);
      case Quantity::kQdd: return accelerations(state.tau);
      case Quantity::kKinetic:
        system_.realize(state_, SimTK::Stage::Velocity);
        return Eigen::MatrixXd::Constant(1, 1, system_.calcKineticEnergy(state_));
      case Quantity::kPotential:
        system_.realize(state_, SimTK::Stage::Dynamics);
        return Eigen::MatrixXd::Constant(1, 1, system_.calcPotentialEnergy(state_));
      case Quantity::kMomentum: return momentum();
    }
    throw std::logic_error("simbody: not answered");
  }

 private:
  struct AppliedWrench {
    int link;
    bool world_axes;
    SimTK::Vec3 force, moment, at;
  };

  void addLink(const scene::Link& link, const RealNumbers<double>& number) {
    const scene::Joint& joint = link.joint;
    SimTK::MobilizedBody& parent =
        link.parent < 0 ? matter_.updGround() : matter_.updMobilizedBody(links_[link.parent]);
    const SimTK::Body::Rigid body(massProperties(link.inertia, number));
    const SimTK::Transform X_before = composed(joint.placement.beforeJoint(), number);
    const SimTK::Transform X_after = composed(joint.placement.afterJoint(), number);
    if (joint.kind == JointKind::kFixed) {
      links_.push_back(
          SimTK::MobilizedBody::Weld(parent, X_before * X_after, body, SimTK::Transform())
              .getMobilizedBodyIndex());
      return;
    }
    // a pin turns about z, a slider moves along x
    const bool slides = joint.kind == JointKind::kPrismatic;
    const SimTK::Transform X_axis(SimTK::Rotation(SimTK::UnitVec3(vec3(joint.axis, number)),
                                                  slides ? SimTK::CoordinateAxis(SimTK::XAxis)
                                                         : SimTK::CoordinateAxis(SimTK::ZAxis)));
    const SimTK::Transform X_PF = X_before * X_axis, X_BM = ~X_after * X_axis;
    SimTK::MobilizedBody moved;
    if (slides)
      moved = SimTK::MobilizedBody::Slider(parent, X_PF, body, X_BM);
    else
      moved = SimTK::MobilizedBody::Pin(parent, X_PF, body, X_BM);
    links_.push_back(moved.getMobilizedBodyIndex());
    joints_.push_back(moved);
    const double stiffness = number(joint.stiffness);
    if (stiffness != 0)
      SimTK::Force::MobilityLinearSpring(forces_, moved, SimTK::MobilizerQIndex(0), stiffness,
                                         number(joint.rest));
    rotors_.emplace_back();
    const double rotor = number(joint.rotor_inertia), gear = number(joint.gear_ratio);
    if (rotor != 0) addRotor(rotor, gear);
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
    rotors_.back() = {rotor, gear};
  }

  bool hasRotor(std::size_t i) const { return !rotors_[i].body.isEmptyHandle(); }

  void setMotion(const scene::State<double>& state, bool moving) {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const double q = state.x[i].q, u = moving ? state.qd[i] : 0;
      joints_[i].setOneQ(state_, 0, q);
      joints_[i].setOneU(state_, 0, u);
      if (hasRotor(i)) {
        rotors_[i].body.setOneQ(state_, 0, rotors_[i].gear_ratio * q);
        rotors_[i].body.setOneU(state_, 0, rotors_[i].gear_ratio * u);
      }
    }
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
    Eigen::VectorXd out(joints_.size());
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      out(i) = mobility_forces[uIndex(joints_[i])];
      if (hasRotor(i))
        out(i) += rotors_[i].gear_ratio * mobility_forces[uIndex(rotors_[i].body)];
    }
    return out;
  }
  SimTK::Vector expanded(const std::vector<double>& joint_rates) const {
    SimTK::Vector out(state_.getNU(), 0.0);
    for (std::size_t i = 0; i < joint_rates.size(); ++i) {
      out[uIndex(joints_[i])] = joint_rates[i];
      if (hasRotor(i)) out[uIndex(rotors_[i].body)] = rotors_[i].gear_ratio * joint_rates[i];
    }
    return out;
  }
  int uIndex(const SimTK::MobilizedBody& body) const { return body.getFirstUIndex(state_); }

  Eigen::MatrixXd massMatrix() {
    system_.realize(state_, SimTK::Stage::Position);
    const int n = static_cast<int>(joints_.size());
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
                                                 expanded(qdd), out);
    return reduced(out);
  }

  Eigen::VectorXd accelerations(const std::vector<double>& tau) {
    if (has_rotors_) {  // Simbody's M and bias with the rotors, solved here
      const Eigen::VectorXd bias = residual({}, true);
      return massMatrix().ldlt().solve(
          Eigen::Map<const Eigen::VectorXd>(tau.data(), tau.size()) - bias);
    }
    for (std::size_t i = 0; i < joints_.size(); ++i)
      loads_.setOneMobilityForce(state_, joints_[i], SimTK::MobilizerUIndex(0), tau[i]);
    system_.realize(state_, SimTK::Stage::Acceleration);
    Eigen::VectorXd out(joints_.size());
    for (std::size_t i = 0; i < joints_.size(); ++i) out(i) = joints_[i].getOneUDot(state_, 0);
    return out;
  }

  Eigen::VectorXd momentum() {
    system_.realize(state_, SimTK::Stage::Velocity);
    SimTK::Vec3 linear(0), angular(0);
    for (const SimTK::MobilizedBodyIndex& link : links_) {
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
  bool has_rotors_;
  EngineBound bound_;
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::DiscreteForces loads_;
  std::vector<SimTK::MobilizedBodyIndex> links_;  ///< one a scene link
  std::vector<SimTK::MobilizedBody> joints_;      ///< one a degree of freedom
  std::vector<Rotor> rotors_;                     ///< one a degree of freedom, empty without rotor
  std::vector<AppliedWrench> wrenches_;
  SimTK::State state_;
};

constexpr const char* kConventions =
    "reads: the scene, placed with Simbody's own Rotation and Transform, inertias turned and shifted "
    "by its Inertia; fixed joints are welds\n"
    "spatial vectors: angular part first, ground axes, about the body's origin\n"
    "joint axis: a Pin turns about z, a Slider moves along x of its frame\n"
    "inertia: given about the centre of mass, kept about the body's origin\n"
    "bias: c is the residual force of inverse dynamics without applied forces and accelerations; g "
    "is that of the applied forces at rest\n"
    "gravity: Force::Gravity takes the acceleration of a falling body, as in the scene\n"
    "springs: MobilityLinearSpring, an applied force\n"
    "rotors: each is a body pinned to the ground that turns gear_ratio times as fast; then M and "
    "bias are Simbody's, and M qdd = tau - bias is solved here\n"
    "loads: body forces about the body's origin, ground axes\n"
    "known loss: none";

std::string simbodyVersion() {
  int major = 0, minor = 0, build = 0;
  SimTK_version_simbody(&major, &minor, &build);
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(build);
}

}  // namespace

Eigen::VectorXd simbodyClosedAccelerations(const scene::Scene& scene,
                                           const scene::State<double>& state) {
  return SimbodyWitness(scene, true).value(Quantity::kQdd, state);
}

WitnessKind simbodyKind() {
  WitnessInfo info;
  info.name = "simbody";
  info.version = simbodyVersion();
  info.method = "Simbody; rotors as bodies of their own";
  info.conventions = kConventions;
  return {info, [](const scene::Scene& scene) -> std::unique_ptr<Witness> {
            return std::make_unique<SimbodyWitness>(scene);
          }};
}

}  // namespace dynwitness::crosscheck
