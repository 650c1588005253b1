// SPDX-License-Identifier: GPL-3.0-or-later
// Orocos KDL as a witness. The tree is built from KDL's own joints, frames and inertias; rows of
// Denavit-Hartenberg parameters go through KDL's own functions for them.
#include <kdl/config.h>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/tree.hpp>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl/treeidsolver_recursive_newton_euler.hpp>
#include <kdl/treejnttojacsolver.hpp>

#include <limits>
#include <optional>

#include <Eigen/Cholesky>

#include "crosscheck/witnesses/coupled.hpp"
#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/engine_modules.hpp"
#include "crosscheck/witnesses/joint_friction.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::RealNumbers;

KDL::Vector vector(const scene::Vector& v, const RealNumbers<double>& number) {
  return {number(v[0]), number(v[1]), number(v[2])};
}
KDL::Rotation rotation(const scene::Vector& rpy, const RealNumbers<double>& number) {
  return KDL::Rotation::RPY(number(rpy[0]), number(rpy[1]), number(rpy[2]));
}

/// Parent's link frame to joint frame, and moved joint frame to link frame.
struct Frames {
  KDL::Frame before, after;
};

Frames framesOf(const scene::Placement& p, const RealNumbers<double>& number) {
  using Convention = scene::Placement::Convention;
  switch (p.convention) {
    case Convention::kXyzRpy:
      return {{rotation(p.rpy, number), vector(p.xyz, number)}, {}};
    case Convention::kDh:
      return {{}, KDL::Frame::DH(number(p.a), number(p.alpha), number(p.d), number(p.theta))};
    case Convention::kMdh:
      return {KDL::Frame::DH_Craig1989(number(p.a), number(p.alpha), number(p.d), number(p.theta)),
              {}};
  }
  throw std::logic_error("kdl: unknown placement");
}

KDL::RigidBodyInertia inertiaOf(const scene::MassProperties& m, const RealNumbers<double>& number) {
  const double mass = number(m.mass);
  const KDL::Vector com = vector(m.com, number);
  const KDL::RotationalInertia given(number(m.xx), number(m.yy), number(m.zz), number(m.xy),
                                     number(m.xz), number(m.yz));
  const KDL::RotationalInertia I =
      (rotation(m.rpy, number) * KDL::RigidBodyInertia(0, KDL::Vector::Zero(), given))
          .getRotationalInertia();
  if (m.about == scene::MassProperties::About::kCenterOfMass)
    return KDL::RigidBodyInertia(mass, com, I);
  // KDL adds the moments of the point mass at com: they are in I already
  const KDL::RotationalInertia of_point =
      KDL::RigidBodyInertia(mass, com, KDL::RotationalInertia::Zero()).getRotationalInertia();
  return KDL::RigidBodyInertia(mass, com, I + (-1.0) * of_point);
}

class KdlWitness : public Witness {
 public:
  explicit KdlWitness(const PreparedScene& scene)
      : friction_(scene.mechanism()),
        bound_(scene),
        solve_bound_(scene, SolvedBy::kMassMatrix, kEngineTurns) {
    const scene::Mechanism& mechanism = scene.mechanism();
    requirePlainJoints(mechanism);
    requirePlainRotors(mechanism);
    const RealNumbers<double> number(mechanism);
    bool is_chain = true;
    for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
      const scene::Link& link = mechanism.links[i];
      is_chain = is_chain && link.parent == static_cast<int>(i) - 1;
      addLink(link, link.parent < 0 ? kWorld : mechanism.links[link.parent].name, number);
    }
    if (mechanism.has_gravity) gravity_ = vector(mechanism.gravity, number);
    for (const scene::Wrench& w : mechanism.wrenches)
      wrenches_.push_back({names_[w.link], w.axes == scene::Wrench::Axes::kWorld,
                           KDL::Wrench(vector(w.force, number), vector(w.moment, number)),
                           vector(w.at, number)});
    findCopiedNumbers(mechanism);
    with_gravity_.emplace(tree_, gravity_);
    without_gravity_.emplace(tree_, KDL::Vector::Zero());
    if (is_chain && tree_.getChain(kWorld, names_.back(), chain_)) {
      chain_mass_.emplace(chain_, gravity_);
      chain_forward_.emplace(chain_, gravity_);
    }
  }

  const std::string& name() const override { return name_; }
  bool answers(Quantity quantity) const override { return quantity != Quantity::kReactions; }

  Answer answer(Quantity quantity, const scene::State<double>& state) override {
    if (quantity == Quantity::kKinetic) return kinetic(state);
    Answer out{value(quantity, state), bound_(quantity, state)};
    if (quantity == Quantity::kQdd)
      solve_bound_.judge(state, bound_(Quantity::kTau, moving(state, out.value)), out);
    return out;
  }

 private:
  static constexpr const char* kWorld = ".world";

  struct AppliedWrench {
    std::string link;
    bool world_axes;
    KDL::Wrench wrench;
    KDL::Vector at;
  };
  struct Spring {
    double stiffness, rest;
  };

  void addLink(const scene::Link& link, const std::string& parent,
               const RealNumbers<double>& number) {
    using scene::JointKind;
    const scene::Joint& joint = link.joint;
    const Frames frames = framesOf(joint.placement, number);
    KDL::Joint moving(joint.name, KDL::Joint::Fixed);
    if (joint.kind != JointKind::kFixed) {
      const double gear = number(joint.gear_ratio);
      moving = KDL::Joint(
          joint.name, frames.before.p, frames.before.M * vector(joint.axis, number),
          joint.kind == JointKind::kRevolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis,
          /*scale*/ 1, /*offset*/ 0, gear * gear * number(joint.rotor_inertia));
      springs_.push_back({number(joint.stiffness), number(joint.rest)});
    }
    tree_.addSegment(KDL::Segment(link.name, moving, frames.before * frames.after,
                                  inertiaOf(link.inertia, number)),
                     parent);
    names_.push_back(link.name);
  }

  /** KDL numbers joints in the order in which they were added; a copy of a tree adds them again,
      depth first. The solvers of frames and jacobians keep copies, those of inverse dynamics
      references. */
  void findCopiedNumbers(const scene::Mechanism& mechanism) {
    const KDL::Tree copy(tree_);
    for (const int i : mechanism.movingLinks())
      copied_numbers_.push_back(
          static_cast<Eigen::Index>(GetTreeElementQNr(copy.getSegment(names_[i])->second)));
  }
  KDL::JntArray renumbered(const KDL::JntArray& x) const {
    KDL::JntArray out(x.rows());
    for (unsigned i = 0; i < x.rows(); ++i) out.data(copied_numbers_[i]) = x.data(i);
    return out;
  }

  static KDL::JntArray array(const std::vector<double>& v) {
    KDL::JntArray out(static_cast<unsigned>(v.size()));
    out.data = Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
    return out;
  }

  static KDL::JntArray positions(const scene::State<double>& state) {
    std::vector<double> q;
    for (const auto& x : state.x) q.push_back(x.q);
    return array(q);
  }

  KDL::Frame frameOf(const std::string& link, const KDL::JntArray& q) {
    KDL::Frame frame;
    KDL::TreeFkSolverPos_recursive(tree_).JntToCart(renumbered(q), frame, link);
    return frame;
  }

  /// Link by link, in link axes about the link's origin.
  KDL::WrenchMap loads(const KDL::JntArray& q) {
    KDL::WrenchMap out;
    for (const AppliedWrench& w : wrenches_) {
      const KDL::Wrench at_point = w.world_axes ? frameOf(w.link, q).M.Inverse(w.wrench) : w.wrench;
      out[w.link] += at_point.RefPoint(-w.at);
    }
    return out;
  }

  static Eigen::VectorXd inverse(KDL::TreeIdSolver_RNE& solver, const KDL::JntArray& q,
                                 const KDL::JntArray& qd, const KDL::JntArray& qdd,
                                 const KDL::WrenchMap& loads) {
    KDL::JntArray tau(q.rows());
    const int error = solver.CartToJnt(q, qd, qdd, loads, tau);
    if (error < 0) throw std::runtime_error(solver.strError(error));
    return tau.data;
  }

  Eigen::VectorXd springForces(const KDL::JntArray& q) const {
    Eigen::VectorXd out(q.rows());
    for (Eigen::Index i = 0; i < out.size(); ++i)
      out(i) = springs_[i].stiffness * (q.data(i) - springs_[i].rest);
    return out;
  }

  Eigen::MatrixXd massMatrix(const KDL::JntArray& q) {
    const unsigned n = q.rows();
    const KDL::JntArray zero(n);
    if (chain_mass_) {
      KDL::JntSpaceInertiaMatrix M(n);
      chain_mass_->JntToMass(q, M);
      return M.data;
    }
    Eigen::MatrixXd M(n, n);
    for (unsigned j = 0; j < n; ++j) {
      KDL::JntArray unit(n);
      unit(j) = 1;
      M.col(j) = inverse(*without_gravity_, q, zero, unit, {});
    }
    return M;
  }

  Eigen::VectorXd accelerations(const KDL::JntArray& q, const KDL::JntArray& qd,
                                const KDL::JntArray& tau) {
    const KDL::WrenchMap on_links = loads(q);
    KDL::JntArray left = tau;
    left.data -= springForces(q);
    const KDL::JntArray zero(q.rows());
    if (!chain_forward_)  // KDL has no forward dynamics of trees: its M and bias, solved here
      return massMatrix(q).ldlt().solve(left.data - inverse(*with_gravity_, q, qd, zero, on_links));
    KDL::Wrenches by_segment(chain_.getNrOfSegments(), KDL::Wrench::Zero());
    for (unsigned i = 0; i < chain_.getNrOfSegments(); ++i) {
      const auto found = on_links.find(chain_.getSegment(i).getName());
      if (found != on_links.end()) by_segment[i] = found->second;
    }
    KDL::JntArray qdd(q.rows());
    const int error = chain_forward_->CartToJnt(q, qd, left, by_segment, qdd);
    if (error < 0) throw std::runtime_error(chain_forward_->strError(error));
    return qdd.data;
  }

  /// qd' M qd / 2, and what the errors of M and of the sum (4 n roundings) make of it.
  Answer kinetic(const scene::State<double>& state) {
    const Eigen::VectorXd qd = array(state.qd).data;
    const Eigen::MatrixXd M = massMatrix(positions(state));
    const double u = std::numeric_limits<double>::epsilon() / 2;
    const Eigen::MatrixXd error =
        bound_(Quantity::kM, state) + 4 * u * static_cast<double>(qd.size()) * M.cwiseAbs();
    return {qd.transpose() * M * qd / 2, qd.cwiseAbs().transpose() * error * qd.cwiseAbs() / 2};
  }

  struct Motion {
    KDL::RigidBodyInertia I;  ///< world axes, about the link's origin
    KDL::Frame frame;
    KDL::Twist velocity;  ///< world axes, of the link's origin
  };
  std::vector<Motion> motions(const KDL::JntArray& q, const KDL::JntArray& qd) {
    KDL::TreeJntToJacSolver solver(tree_);
    KDL::Jacobian J(q.rows());
    std::vector<Motion> out;
    for (const std::string& link : names_) {
      solver.JntToJac(renumbered(q), J, link);
      KDL::Twist velocity;
      KDL::MultiplyJacobian(J, renumbered(qd), velocity);
      const KDL::Frame frame = frameOf(link, q);
      const KDL::Segment& segment = GetTreeElementSegment(tree_.getSegment(link)->second);
      out.push_back({frame.M * segment.getInertia(), frame, velocity});
    }
    return out;
  }

  double potential(const KDL::JntArray& q) {
    double V = 0;
    for (const Motion& m : motions(q, KDL::JntArray(q.rows())))
      V -= KDL::dot(gravity_, m.I.getMass() * m.frame.p + m.I.getCOG() * m.I.getMass());
    for (unsigned i = 0; i < q.rows(); ++i) {
      const double stretch = q(i) - springs_[i].rest;
      V += springs_[i].stiffness * stretch * stretch / 2;
    }
    return V;
  }

  Eigen::VectorXd momentum(const KDL::JntArray& q, const KDL::JntArray& qd) {
    KDL::Wrench sum = KDL::Wrench::Zero();
    for (const Motion& m : motions(q, qd)) sum += (m.I * m.velocity).RefPoint(-m.frame.p);
    Eigen::VectorXd out(6);
    for (int k = 0; k < 6; ++k) out(k) = sum(k);
    return out;
  }

  Eigen::MatrixXd value(Quantity quantity, const scene::State<double>& state) override {
    if (quantity == Quantity::kKinetic) return kinetic(state).value;
    return friction_.around(quantity, state, [&](const scene::State<double>& without) {
      return frictionless(quantity, without);
    });
  }
  Eigen::MatrixXd frictionless(Quantity quantity, const scene::State<double>& state) {
    const KDL::JntArray q = positions(state), qd = array(state.qd), zero(q.rows());
    switch (quantity) {
      case Quantity::kM:
        return massMatrix(q);
      case Quantity::kc:
        return inverse(*without_gravity_, q, qd, zero, {});
      case Quantity::kg:
        return inverse(*with_gravity_, q, zero, zero, {}) + springForces(q);
      case Quantity::kTau:
        return inverse(*with_gravity_, q, qd, array(state.qdd), loads(q)) + springForces(q);
      case Quantity::kQdd:
        return accelerations(q, qd, array(state.tau));
      case Quantity::kPotential:
        return Eigen::MatrixXd::Constant(1, 1, potential(q));
      case Quantity::kMomentum:
        return momentum(q, qd);
      case Quantity::kKinetic:
      case Quantity::kReactions:
        break;
    }
    throw std::logic_error("kdl: unknown quantity");
  }

  std::string name_ = kKdl.name;
  JointFriction friction_;
  EngineBound bound_;
  SolveBound solve_bound_;
  KDL::Tree tree_{kWorld};
  KDL::Chain chain_;  ///< the tree, where it does not branch
  KDL::Vector gravity_ = KDL::Vector::Zero();
  std::vector<std::string> names_;            ///< of segments, one a scene link
  std::vector<Spring> springs_;               ///< one a degree of freedom
  std::vector<Eigen::Index> copied_numbers_;  ///< of the same, in a copy of the tree
  std::vector<AppliedWrench> wrenches_;
  std::optional<KDL::TreeIdSolver_RNE> with_gravity_, without_gravity_;
  std::optional<KDL::ChainDynParam> chain_mass_;
  std::optional<KDL::ChainFdSolver_RNE> chain_forward_;
};

constexpr const char* kConventions =
    "reads: the scene, through KDL's Frame, Frame::DH, Frame::DH_Craig1989, Joint and "
    "RigidBodyInertia (KDL has no reader of its own)\n"
    "spatial vectors: linear part first; twists and wrenches about the tip frame of a segment\n"
    "joint axis: a point and a direction in the parent's tip frame; the link's frame is the tip\n"
    "inertia: given about the centre of mass, kept about the tip frame's origin\n"
    "bias: c comes from inverse dynamics without gravity and acceleration\n"
    "gravity: the solvers take the acceleration of a falling body, as in the scene\n"
    "springs: Joint has a stiffness that no solver reads; stiffness (q - rest) is added here\n"
    "friction: its own is off; viscous and Coulomb friction are added here\n"
    "rotors: Joint's inertia = gear_ratio^2 rotor_inertia, read by the solvers of M and of tau\n"
    "loads: wrenches on segments, in the axes of the segment\n"
    "joint numbers: as added, but depth first in a copy of the tree (Tree's copy constructor), "
    "and the solvers of "
    "frames and jacobians keep copies; renumbered here\n"
    "branches: M column by column from inverse dynamics, and M qdd = tau - bias solved here, since "
    "KDL's solvers for both take chains only\n"
    "energies, momentum: KDL has no functions for them; T = qd' M qd / 2 with its M, the others "
    "are "
    "summed here over its frames, jacobians and inertias\n"
    "known loss: none";

std::vector<WitnessKind> kinds() {
  WitnessInfo info;
  info.name = kKdl.name;
  info.version = KDL_VERSION_STRING;
  info.method = kKdl.method;
  info.conventions = kConventions;
  return {overTree(engineKind<KdlWitness>(info))};
}

}  // namespace
}  // namespace dynwitness::crosscheck

const dynwitness::crosscheck::EngineModule dynwitness_engine = {
    DYNWITNESS_VERSION, dynwitness::crosscheck::kinds, nullptr, nullptr, nullptr};
