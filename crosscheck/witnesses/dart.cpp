// SPDX-License-Identifier: GPL-3.0-or-later
// DART as a witness. It reads the mechanism from URDF: the scene's own file, or one written for it.
// What URDF cannot say is set in DART's skeleton: gravity, springs; rotors as bodies of their own;
// joints of several degrees of freedom and screws, which the URDF has as revolute ones, in the same
// place and about the same axis, and which are then exchanged for DART's own.
//
// DART's BallJoint and FreeJoint turn by the exponential of a rotation vector, and their speeds are
// those of the body, in the axes of the moved joint frame, the angular part first. Their Jacobian
// is constant there, so that accelerations are the derivatives of the speeds as they stand: the
// scene's rates in another order, and nothing like w x v is left to convert. (By test: a free body
// at speeds v, w and accelerations 0 has BodyNode::getSpatialAcceleration() = 0.)
//
// DART's joint springs are those of an implicit integrator: with the time step h they push with
// -k (q + h qd - rest), and forward dynamics divides by M + h^2 k. The skeleton therefore gets a
// time step so small that h k is nothing beside the last digit of anything.
//
// Debian's DART was compiled for plain x86-64: this file must not be compiled with -march=native,
// which would change the alignment of Eigen's types in DART's classes.
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/DegreeOfFreedom.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PlanarJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/ScrewJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/UniversalJoint.hpp>
#include <dart/utils/urdf/DartLoader.hpp>

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <boost/math/constants/constants.hpp>

#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/engine_modules.hpp"
#include "crosscheck/witnesses/hushed.hpp"
#include "crosscheck/witnesses/joint_friction.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/own_file.hpp"
#include "crosscheck/witnesses/own_steps.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "scene/inertia_need.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

using dart::dynamics::BodyNode;
using dart::dynamics::DegreeOfFreedom;
using dart::dynamics::SkeletonPtr;
using Eigen::Vector3d;
using scene::JointKind;
using scene::RealNumbers;
namespace joints = dart::dynamics;

Vector3d vector(const scene::Vector& v, const RealNumbers<double>& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

/// The scene that DART is told: in place of a joint that URDF cannot say, a revolute one.
scene::Scene told(scene::Scene scene) {
  for (scene::Link& link : scene.mechanism.links)
    if (!isPlain(link.joint.kind)) link.joint.kind = JointKind::kRevolute;
  return scene;
}

/** The rotation vector of a quaternion (w, x, y, z) of any length other than 0: the axis times an
    angle of at most pi. Below 1e-3 rad DART's expMapRot breaks the series of the exponential off,
    which leaves up to 2e-10 of R: such a turn is told as one of almost 2 pi the other way. Long
    double, so that the rounding of the vector is all that is lost here. */
Vector3d rotationVector(const scene::JointPosition<double>* q) {
  using Real = long double;
  const Real w = q[0].q, x = q[1].q, y = q[2].q, z = q[3].q;
  const Real sine = std::sqrt(x * x + y * y + z * z);  // of half the angle, times the length
  if (sine == 0) return Vector3d::Zero();
  Real angle = 2 * std::atan2(sine, std::abs(w));
  if (angle < Real(1.001e-3)) angle -= boost::math::constants::two_pi<Real>();
  const Real scale = (w < 0 ? -angle : angle) / sine;
  return {static_cast<double>(scale * x), static_cast<double>(scale * y),
          static_cast<double>(scale * z)};
}

SkeletonPtr loaded(const std::string& urdf) {
  using dart::utils::DartLoader;
  // it warns of each link without mass, and says which names it gives to the joints put in here
  const Hushed hushed;
  // DART's defaults are a root that floats, and 1 kg for a link without <inertial>
  const dart::dynamics::Inertia none(0, Vector3d::Zero(), Eigen::Matrix3d::Zero());
  DartLoader loader(DartLoader::Options(nullptr, DartLoader::RootJointType::FIXED, none));
  SkeletonPtr skeleton = loader.parseSkeletonString(urdf, "");
  if (!skeleton) throw std::runtime_error("DART does not read the URDF: " + hushed.text());
  return skeleton;
}

/// A time step in which springs push as they stand [s].
constexpr double kNoTime = 1e-100;

bool movesInertiaOfJoints(const scene::Scene& scene) {
  try {
    scene::requireInertiaOfJoints(scene, "");
    return true;
  } catch (const scene::InputError&) {
    return false;
  }
}

class DartWitness : public Witness, public FileReader, public OwnSteps {
 public:
  explicit DartWitness(const PreparedScene& scene)
      : friction_(scene.mechanism()), bound_(scene, 1, Attitude::kRotationVector) {
    const scene::Scene told_scene = told(scene.scene());
    const std::string urdf = scene::urdfForEngines(told_scene);
    own_file_ = isOwnFile(urdf, told_scene);
    skeleton_ = loaded(urdf);
    const scene::Mechanism& mechanism = scene.mechanism();
    requirePlainRotors(mechanism);
    has_inverse_ = movesInertiaOfJoints(scene.scene());
    const RealNumbers<double> number(mechanism);
    skeleton_->setTimeStep(kNoTime);
    skeleton_->setGravity(mechanism.has_gravity ? vector(mechanism.gravity, number)
                                                : Vector3d::Zero());
    for (const scene::Link& link : mechanism.links) findLink(link, number);
    for (const scene::Wrench& w : mechanism.wrenches)
      wrenches_.push_back({links_[w.link], w.axes == scene::Wrench::Axes::kLink,
                           vector(w.force, number), vector(w.moment, number),
                           vector(w.at, number)});
    solve_bound_ = std::make_unique<SolveBound>(
        scene, has_rotors_ ? SolvedBy::kMassMatrix : SolvedBy::kSweep, kEngineTurns);
  }

  const std::string& name() const override { return name_; }
  /// Its sweep of forward dynamics ends the process at a joint that moves no inertia.
  bool answers(Quantity quantity) const override {
    return quantity != Quantity::kReactions && (quantity != Quantity::kQdd || has_inverse_);
  }
  bool readsOwnFile() const override { return own_file_; }

  /// As World::step does where nothing is in contact: semi-implicit Euler, springs implicit.
  OwnMotion ownMotion(const scene::State<double>& start, double step, long steps,
                      long every) override {
    if (has_rotors_)
      throw std::runtime_error("DART has no rotors: their inertia is not in its own steps");
    for (const Joint& joint : joints_)
      if (!isPlain(joint.kind) && joint.kind != JointKind::kHelical)
        throw std::runtime_error("joints of several axes are not moved by its own steps here");
    setState(start, true);
    OwnMotion out;
    out.by = fmt::format("dart, semi-implicit Euler, steps of {} s", step);
    for (long k = 0;; ++k) {
      if (k % every == 0) {
        skeleton_->computeForwardDynamics();
        OwnMotion::Moment moment{static_cast<double>(k) * step, {}, {}, {}};
        for (const Joint& joint : joints_) {
          moment.q.push_back(joint.joint->getPosition());
          moment.qd.push_back(joint.joint->getVelocity());
          moment.qdd.push_back(joint.joint->getAcceleration());
        }
        out.moments.push_back(std::move(moment));
      }
      if (k == steps) break;
      skeleton_->setTimeStep(step);
      skeleton_->computeForwardDynamics();
      skeleton_->integrateVelocities(step);
      skeleton_->integratePositions(step);
      skeleton_->setTimeStep(kNoTime);
    }
    return out;
  }

  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    Answer out{value(quantity, state), bound_(quantity, state)};
    if (quantity == Quantity::kQdd)
      solve_bound_->judge(state, bound_(Quantity::kTau, moving(state, out.value)), out);
    return out;
  }

 private:
  /// One degree of freedom of the scene; of a floating joint, too, linear ones come first. A geared
  /// rotor is a body of its own, pinned to the world,
  /// that turns n times as fast as the joint.
  struct Joint {
    DegreeOfFreedom* joint;
    DegreeOfFreedom* rotor;  ///< null: none
    double gear_ratio;
    JointKind kind;  ///< of the scene's joint
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
    joints::Joint* joint = skeleton_->getJoint(link.joint.name);
    if (!joint || joint->getNumDofs() != 1)
      throw std::runtime_error("DART did not make '" + link.joint.name + "' of the URDF");
    if (scene::degreesOfFreedom(link.joint.kind) > 1) {
      for (DegreeOfFreedom* dof : exchanged(*joint, link.joint))
        joints_.push_back({dof, nullptr, 1, link.joint.kind});
      return;
    }
    if (link.joint.kind == JointKind::kHelical) {
      const Hushed hushed;
      auto screw = like<joints::ScrewJoint>(*joint, "screw");
      screw.mAxis = axisOf(*joint);
      screw.mPitch = boost::math::constants::two_pi<double>() * number(link.joint.pitch);
      joint = exchange<joints::ScrewJoint>(*joint, screw);
    }
    DegreeOfFreedom* dof = joint->getDof(0);
    dof->setDampingCoefficient(0);  // a URDF file may have it
    dof->setSpringStiffness(number(link.joint.stiffness));
    dof->setRestPosition(number(link.joint.rest));
    const double gear = number(link.joint.gear_ratio), J = number(link.joint.rotor_inertia);
    joints_.push_back(
        {dof, J == 0 ? nullptr : addRotor(link.joint.name + ".rotor", J), gear, link.joint.kind});
    has_rotors_ = has_rotors_ || J != 0;
  }

  /// Of the joint that DART made of the URDF, as a unit vector.
  static Vector3d axisOf(const joints::Joint& revolute) {
    return dynamic_cast<const joints::RevoluteJoint&>(revolute).getAxis();
  }

  /// In the same place as another joint.
  template <typename Made>
  static typename Made::Properties like(const joints::Joint& joint, const char* what) {
    typename Made::Properties made;
    made.mName = joint.getName() + "." + what;
    made.mT_ParentBodyToJoint = joint.getTransformFromParentBodyNode();
    made.mT_ChildBodyToJoint = joint.getTransformFromChildBodyNode();
    return made;
  }
  template <typename Made>
  static Made* exchange(joints::Joint& joint, const typename Made::Properties& made) {
    return joint.getChildBodyNode()->changeParentJointType<Made>(made);
  }

  /// Puts DART's own joint in a revolute one's place. @return in the order of the scene's rates
  std::vector<DegreeOfFreedom*> exchanged(joints::Joint& joint, const scene::Joint& wanted) {
    const Hushed hushed;
    const auto inOrder = [](joints::Joint* made, std::initializer_list<int> order) {
      std::vector<DegreeOfFreedom*> dofs;
      for (const int k : order) dofs.push_back(made->getDof(static_cast<std::size_t>(k)));
      return dofs;
    };
    switch (wanted.kind) {
      case JointKind::kSpherical:
        return inOrder(exchange<joints::BallJoint>(joint, like<joints::BallJoint>(joint, "ball")),
                       {0, 1, 2});
      case JointKind::kFloating:
        return inOrder(exchange<joints::FreeJoint>(joint, like<joints::FreeJoint>(joint, "free")),
                       {3, 4, 5, 0, 1, 2});
      case JointKind::kUniversal: {
        auto made = like<joints::UniversalJoint>(joint, "universal");
        made.mAxis = {Vector3d::UnitX(), Vector3d::UnitY()};
        return inOrder(exchange<joints::UniversalJoint>(joint, made), {0, 1});
      }
      case JointKind::kPlanar: {  // Rz(alpha) Ry(beta) takes z to the axis, x and y to these
        const Vector3d z = axisOf(joint);
        const double rho = std::hypot(z[0], z[1]);
        const Vector3d y = rho == 0 ? Vector3d(0, 1, 0) : Vector3d(-z[1] / rho, z[0] / rho, 0);
        auto made = like<joints::PlanarJoint>(joint, "planar");
        made.setArbitraryPlane(y.cross(z), y);
        return inOrder(exchange<joints::PlanarJoint>(joint, made), {0, 1, 2});
      }
      case JointKind::kCylindrical: {  // a body without mass slides, and carries the one that turns
        auto slide = like<joints::PrismaticJoint>(joint, "slide");
        auto turn = like<joints::RevoluteJoint>(joint, "turn");
        slide.mAxis = turn.mAxis = axisOf(joint);
        slide.mT_ChildBodyToJoint.setIdentity();
        turn.mT_ParentBodyToJoint.setIdentity();
        BodyNode::Properties sliding;
        sliding.mName = slide.mName;
        sliding.mInertia = joints::Inertia(0, Vector3d::Zero(), Eigen::Matrix3d::Zero());
        BodyNode* body = joint.getChildBodyNode();
        const auto made = skeleton_->createJointAndBodyNodePair<joints::PrismaticJoint>(
            body->getParentBodyNode(), slide, sliding);
        joints::Joint* turning = body->moveTo<joints::RevoluteJoint>(made.second, turn);
        return {made.first->getDof(0), turning->getDof(0)};
      }
      default:
        throw std::logic_error("dart: unknown joint kind");
    }
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

  /// Positions of the degrees of freedom: DART's rotation vectors in place of quaternions.
  std::vector<double> coordinates(const scene::State<double>& state) const {
    std::vector<double> q;
    const scene::JointPosition<double>* x = state.x.data();
    while (q.size() < joints_.size()) {
      const JointKind kind = joints_[q.size()].kind;
      const bool turns = !scene::ratesArePositionDerivatives(kind);
      for (int k = scene::degreesOfFreedom(kind) - (turns ? 3 : 0); k > 0; --k)
        q.push_back((x++)->q);
      if (!turns) continue;
      const Vector3d r = rotationVector(x);
      q.insert(q.end(), r.data(), r.data() + 3);
      x += 4;
    }
    return q;
  }

  void setState(const scene::State<double>& state, bool moving) {
    const std::vector<double> q = coordinates(state), zeros(q.size(), 0.0);
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

  std::string name_ = kDart.name;
  JointFriction friction_;
  EngineBound bound_;
  bool own_file_ = false, has_inverse_ = true;
  SkeletonPtr skeleton_;
  bool has_rotors_ = false;
  std::vector<BodyNode*> links_;  ///< one a scene link; null: the world
  std::vector<Joint> joints_;     ///< one a degree of freedom, in the scene's order
  std::vector<AppliedWrench> wrenches_;
  std::unique_ptr<SolveBound> solve_bound_;
};

constexpr const char* kConventions =
    "reads: URDF, parsed by urdfdom into doubles and quaternions: the user's own file, without "
    "geometry, where the scene is one, otherwise one written from the scene\n"
    "its defaults, not used: a root that floats, 1 kg for a link without <inertial>\n"
    "spatial vectors: angular part first, link axes, about the link's origin\n"
    "inertia: mass, centre of mass, the six moments about it\n"
    "bias: getCoriolisForces = c; c is velocity products only\n"
    "gravity: setGravity takes the acceleration of a falling body, as in the scene; g comes from "
    "inverse dynamics at rest, so that the springs are in it\n"
    "joints: BallJoint, FreeJoint, UniversalJoint, PlanarJoint and ScrewJoint are put in the place "
    "of revolute ones of the URDF; a cylindrical joint is a PrismaticJoint, a body without mass and "
    "a RevoluteJoint\n"
    "orientations: a rotation vector; below 1e-3 rad, where DART breaks the series of its "
    "exponential off, one of almost 2 pi the other way\n"
    "speeds: those of BallJoint and FreeJoint are the body's own in its axes, as in the scene, "
    "angular part first\n"
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

std::vector<WitnessKind> kinds() {
  WitnessInfo info;
  info.name = kDart.name;
  info.version = DART_VERSION;
  info.method = kDart.method;
  info.conventions = kConventions;
  return {overTree(engineKind<DartWitness>(info))};
}

}  // namespace
}  // namespace dynwitness::crosscheck

const dynwitness::crosscheck::EngineModule dynwitness_engine = {
    DYNWITNESS_VERSION, dynwitness::crosscheck::kinds, nullptr, nullptr, nullptr};
