// SPDX-License-Identifier: GPL-3.0-or-later
// DART as a witness. It reads the mechanism from URDF: the scene's own file, or one written for it.
// What URDF cannot say is set in DART's skeleton: gravity, springs; rotors as bodies of their own.
//
// DART's joint springs are those of an implicit integrator: with the time step h they push with
// -k (q + h qd - rest), and forward dynamics divides by M + h^2 k. The skeleton therefore gets a
// time step so small that h k is nothing beside the last digit of anything.
//
// Debian's DART was compiled for plain x86-64: this file must not be compiled with -march=native,
// which would change the alignment of Eigen's types in DART's classes.
#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/joint_friction.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/witnesses.hpp"

#ifdef DYNWITNESS_HAS_DART
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/DegreeOfFreedom.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/utils/urdf/DartLoader.hpp>

#include <iostream>
#include <sstream>

#include <Eigen/Cholesky>

#include "crosscheck/witnesses/engine_bound.hpp"
#include "scene/numbers.hpp"
#endif

namespace dynwitness::crosscheck {
namespace {

constexpr const char* kName = "dart";
constexpr const char* kMethod =
    "DART reads the URDF; articulated bodies in link axes; rotors as bodies of their own";

#ifdef DYNWITNESS_HAS_DART

using dart::dynamics::BodyNode;
using dart::dynamics::DegreeOfFreedom;
using dart::dynamics::SkeletonPtr;
using Eigen::Vector3d;
using scene::RealNumbers;

Vector3d vector(const scene::Vector& v, const RealNumbers<double>& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

/// Keeps what is written to std::cerr while it lives. DART warns there of each link without mass.
class Hushed {
 public:
  Hushed() : original_(std::cerr.rdbuf(heard_.rdbuf())) {}
  ~Hushed() { std::cerr.rdbuf(original_); }
  Hushed(const Hushed&) = delete;
  Hushed& operator=(const Hushed&) = delete;
  std::string text() const { return heard_.str(); }

 private:
  std::ostringstream heard_;
  std::streambuf* original_;
};

SkeletonPtr loaded(const scene::Scene& scene) {
  requirePlainJoints(scene.mechanism);
  using dart::utils::DartLoader;
  const Hushed hushed;
  // DART's defaults are a root that floats, and 1 kg for a link without <inertial>
  const dart::dynamics::Inertia none(0, Vector3d::Zero(), Eigen::Matrix3d::Zero());
  DartLoader loader(DartLoader::Options(nullptr, DartLoader::RootJointType::FIXED, none));
  SkeletonPtr skeleton = loader.parseSkeletonString(scene::urdfForEngines(scene), "");
  if (!skeleton) throw std::runtime_error("DART does not read the URDF: " + hushed.text());
  return skeleton;
}

class DartWitness : public Witness {
 public:
  explicit DartWitness(const scene::Scene& scene)
      : friction_(scene.mechanism), bound_(scene.mechanism), skeleton_(loaded(scene)) {
    const scene::Mechanism& mechanism = scene.mechanism;
    requirePlainRotors(mechanism);
    const RealNumbers<double> number(mechanism);
    skeleton_->setTimeStep(1e-100);
    skeleton_->setGravity(mechanism.has_gravity ? vector(mechanism.gravity, number)
                                                : Vector3d::Zero());
    for (const scene::Link& link : mechanism.links) findLink(link, number);
    for (const scene::Wrench& w : mechanism.wrenches)
      wrenches_.push_back({links_[w.link], w.axes == scene::Wrench::Axes::kLink,
                           vector(w.force, number), vector(w.moment, number),
                           vector(w.at, number)});
    solve_bound_ = std::make_unique<SolveBound>(
        mechanism, has_rotors_ ? SolvedBy::kMassMatrix : SolvedBy::kSweep, kEngineTurns);
  }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity != Quantity::kReactions; }

  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out{value(quantity, state), bound_(quantity, state)};
    if (quantity == Quantity::kQdd)
      solve_bound_->judge(state, bound_(Quantity::kTau, moving(state, out.value)), out);
    return out;
  }

 private:
  /// One degree of freedom of the scene. A geared rotor is a body of its own, pinned to the world,
  /// that turns n times as fast as the joint.
  struct Joint {
    DegreeOfFreedom* joint;
    DegreeOfFreedom* rotor;  ///< null: none
    double gear_ratio;
  };
  struct AppliedWrench {
    BodyNode* body;
    bool link_axes;
    Vector3d force, moment, at;
  };

  void findLink(const scene::Link& link, const RealNumbers<double>& number) {
    BodyNode* body = skeleton_->getBodyNode(link.name);
    // a root called "world" is DART's world, and has no mass
    const bool is_world = link.parent < 0 && link.name == "world";
    if (!body && !(is_world && number(link.inertia.mass) == 0))
      throw std::runtime_error("DART did not make '" + link.name + "' of the URDF");
    links_.push_back(body);
    if (link.joint.kind == scene::JointKind::kFixed) return;
    dart::dynamics::Joint* joint = skeleton_->getJoint(link.joint.name);
    if (!joint || joint->getNumDofs() != 1)
      throw std::runtime_error("DART did not make '" + link.joint.name + "' of the URDF");
    DegreeOfFreedom* dof = joint->getDof(0);
    dof->setDampingCoefficient(0);  // a URDF file may have it
    dof->setSpringStiffness(number(link.joint.stiffness));
    dof->setRestPosition(number(link.joint.rest));
    const double gear = number(link.joint.gear_ratio), J = number(link.joint.rotor_inertia);
    joints_.push_back({dof, J == 0 ? nullptr : addRotor(link.joint.name + ".rotor", J), gear});
    has_rotors_ = has_rotors_ || J != 0;
  }

  DegreeOfFreedom* addRotor(const std::string& name, double J) {
    using dart::dynamics::RevoluteJoint;
    RevoluteJoint::Properties pin;
    pin.mName = name;
    BodyNode::Properties body;
    body.mName = name;
    // its centre of mass rests in the world's origin, so that mass and gravity do nothing
    body.mInertia = dart::dynamics::Inertia(1, Vector3d::Zero(), J * Eigen::Matrix3d::Identity());
    return skeleton_->createJointAndBodyNodePair<RevoluteJoint>(nullptr, pin, body)
        .first->getDof(0);
  }

  template <typename Set>
  void setEach(const std::vector<double>& rates, Set set) {
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      set(joints_[i].joint, rates[i]);
      if (joints_[i].rotor) set(joints_[i].rotor, joints_[i].gear_ratio * rates[i]);
    }
  }

  void setState(const scene::State<double>& state, bool moving) {
    std::vector<double> q;
    for (const auto& x : state.x) q.push_back(x.q);
    const std::vector<double> zeros(q.size(), 0.0);
    setEach(q, [](DegreeOfFreedom* dof, double x) { dof->setPosition(x); });
    setEach(moving ? state.qd : zeros, [](DegreeOfFreedom* dof, double x) { dof->setVelocity(x); });
    setEach(zeros, [](DegreeOfFreedom* dof, double x) {
      dof->setAcceleration(x);
      dof->setForce(x);
    });
    skeleton_->clearExternalForces();
  }

  void applyLoads() {
    for (const AppliedWrench& w : wrenches_) {
      if (!w.body) continue;  // on the world
      w.body->addExtForce(w.force, w.at, w.link_axes, true);
      w.body->addExtTorque(w.moment, w.link_axes);
    }
  }

  /// Mobility space is (joints, rotors); a joint's generalised force is its own plus n times its
  /// rotor's.
  Eigen::VectorXd reduced(const Eigen::VectorXd& forces) const {
    Eigen::VectorXd out(joints_.size());
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const Joint& joint = joints_[i];
      out(i) = forces(joint.joint->getIndexInSkeleton());
      if (joint.rotor) out(i) += joint.gear_ratio * forces(joint.rotor->getIndexInSkeleton());
    }
    return out;
  }

  Eigen::MatrixXd massMatrix() {
    const Eigen::MatrixXd& full = skeleton_->getMassMatrix();
    Eigen::MatrixXd M(joints_.size(), joints_.size());
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      Eigen::VectorXd unit = Eigen::VectorXd::Zero(full.cols());
      unit(joints_[j].joint->getIndexInSkeleton()) = 1;
      if (joints_[j].rotor) unit(joints_[j].rotor->getIndexInSkeleton()) = joints_[j].gear_ratio;
      M.col(j) = reduced(full * unit);
    }
    return M;
  }

  Eigen::VectorXd inverseDynamics(const std::vector<double>& qdd, bool loaded) {
    setEach(qdd, [](DegreeOfFreedom* dof, double x) { dof->setAcceleration(x); });
    constexpr bool kDamping = false, kSprings = true;
    skeleton_->computeInverseDynamics(loaded, kDamping, kSprings);
    return reduced(skeleton_->getForces());
  }

  Eigen::VectorXd accelerations(const std::vector<double>& tau) {
    const std::vector<double> zeros(joints_.size(), 0.0);
    if (has_rotors_) {  // DART's M and bias with the rotors, solved here
      const Eigen::VectorXd bias = inverseDynamics(zeros, true);
      return massMatrix().ldlt().solve(Eigen::Map<const Eigen::VectorXd>(tau.data(), tau.size()) -
                                       bias);
    }
    for (std::size_t i = 0; i < joints_.size(); ++i) joints_[i].joint->setForce(tau[i]);
    skeleton_->computeForwardDynamics();
    return reduced(skeleton_->getAccelerations());
  }

  /// Skeleton::computePotentialEnergy of DART 6.12 takes a link's origin for its centre of mass.
  double potential() {
    double V = 0;
    for (const BodyNode* body : links_)
      if (body) V -= body->getMass() * skeleton_->getGravity().dot(body->getCOM());
    for (const Joint& joint : joints_) V += joint.joint->getJoint()->computePotentialEnergy();
    return V;
  }

  Eigen::VectorXd momentum() {
    Eigen::Vector6d sum = Eigen::Vector6d::Zero();  // DART puts the angular part first
    for (const BodyNode* body : links_)
      if (body)
        sum += dart::math::dAdInvT(body->getWorldTransform(),
                                   body->getSpatialInertia() * body->getSpatialVelocity());
    Eigen::VectorXd out(6);
    out << sum.tail<3>(), sum.head<3>();
    return out;
  }

  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) {
    return friction_.around(quantity, state, [&](const scene::State<double>& without) {
      return frictionless(quantity, without);
    });
  }
  Eigen::MatrixXd frictionless(Quantity quantity, const scene::State<double>& state) {
    const std::vector<double> zeros(joints_.size(), 0.0);
    setState(state, quantity != Quantity::kg);
    if (quantity == Quantity::kTau || quantity == Quantity::kQdd) applyLoads();
    switch (quantity) {
      case Quantity::kM:
        return massMatrix();
      case Quantity::kc:
        return reduced(skeleton_->getCoriolisForces());
      case Quantity::kg:
        return inverseDynamics(zeros, false);
      case Quantity::kTau:
        return inverseDynamics(state.qdd, true);
      case Quantity::kQdd:
        return accelerations(state.tau);
      case Quantity::kKinetic:
        return Eigen::MatrixXd::Constant(1, 1, skeleton_->computeKineticEnergy());
      case Quantity::kPotential:
        return Eigen::MatrixXd::Constant(1, 1, potential());
      case Quantity::kMomentum:
        return momentum();
      case Quantity::kReactions:
        break;
    }
    throw std::logic_error("dart: unknown quantity");
  }

  std::string name_ = kName;
  JointFriction friction_;
  EngineBound bound_;
  SkeletonPtr skeleton_;
  bool has_rotors_ = false;
  std::vector<BodyNode*> links_;  ///< one a scene link; null: the world
  std::vector<Joint> joints_;     ///< one a degree of freedom
  std::vector<AppliedWrench> wrenches_;
  std::unique_ptr<SolveBound> solve_bound_;
};

constexpr const char* kConventions =
    "reads: the URDF itself, parsed by urdfdom into doubles and quaternions, geometry left out\n"
    "its defaults, not used: a root that floats, 1 kg for a link without <inertial>\n"
    "spatial vectors: angular part first, link axes, about the link's origin\n"
    "inertia: mass, centre of mass, the six moments about it\n"
    "bias: getCoriolisForces = c; c is velocity products only\n"
    "gravity: setGravity takes the acceleration of a falling body, as in the scene; g comes from "
    "inverse dynamics at rest, so that the springs are in it\n"
    "springs: those of an implicit integrator, -stiffness (q + h qd - rest), and h^2 stiffness "
    "added to M in forward dynamics; the time step h is 1e-100 s here\n"
    "friction: its own is off; viscous and Coulomb friction are added here\n"
    "rotors: DART has none; each is a body pinned to the world that turns gear_ratio times as "
    "fast\n"
    "loads: addExtForce and addExtTorque, at a point in link axes\n"
    "momentum: body by body in link axes, moved to the world's origin here\n"
    "potential: summed here over DART's centres of mass and joints, since its "
    "computePotentialEnergy takes the link's origin for the centre of mass (dartsim/dart issue "
    "1681, open in 6.12.1)\n"
    "known loss: none";

WitnessKind kind() {
  WitnessInfo info;
  info.name = kName;
  info.version = DART_VERSION;
  info.method = kMethod;
  info.conventions = kConventions;
  return overTree(engineKind<DartWitness>(info));
}
#else
WitnessKind kind() {
  return absentKind(kName, kMethod);
}
#endif

}  // namespace

WitnessKind dartKind() {
  return kind();
}

}  // namespace dynwitness::crosscheck
