// SPDX-License-Identifier: GPL-3.0-or-later
// A part of DART's module: DART called as its users call it, no witness around it, no copies. Like
// its witness not to be compiled with -march=native.
#include "crosscheck/chart/raw_engines.hpp"

#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>

#include <algorithm>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "recursive/model.hpp"

namespace dynwitness::crosscheck {
namespace {

namespace dynamics = dart::dynamics;

/** A model in DART, from the model's own numbers: this is about time, the witness `dart` is about
    trust. Rotors are left out, since DART has none and the bodies that would stand for them cost it
    time. */
class DartSteps : public RawSteps {
 public:
  DartSteps(const recursive::Model<double>& model, double h)
      : model_(model), skeleton_(dynamics::Skeleton::create("model")), h_(h) {
    skeleton_->setTimeStep(h);
    skeleton_->setGravity(model.gravity);
    for (std::size_t i = 0; i < model.links.size(); ++i) {
      const recursive::LinkModel<double>& link = model.links[i];
      dynamics::BodyNode* parent = link.parent < 0 ? nullptr : bodies_[link.parent];
      const std::string name = fmt::format("{}", i);
      if (link.kind == recursive::JointKind::kRevolute) {
        dynamics::RevoluteJoint::Properties joint;
        joint.mAxis = Eigen::Vector3d::UnitZ();
        add(parent, name, link, joint, static_cast<dynamics::RevoluteJoint*>(nullptr));
      } else if (link.kind == recursive::JointKind::kPrismatic) {
        dynamics::PrismaticJoint::Properties joint;
        joint.mAxis = Eigen::Vector3d::UnitZ();
        add(parent, name, link, joint, static_cast<dynamics::PrismaticJoint*>(nullptr));
      } else if (link.kind == recursive::JointKind::kFloating) {
        add(parent, name, link, dynamics::FreeJoint::Properties(),
            static_cast<dynamics::FreeJoint*>(nullptr));
      } else {
        throw std::invalid_argument("expected revolute, prismatic and floating joints");
      }
    }
  }

  void start(const scene::State<double>& s) override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const recursive::LinkModel<double>& link = model_.links[i];
      dynamics::Joint* joint = bodies_[i]->getParentJoint();
      const double *qd = &s.qd[link.dof], *tau = &s.tau[link.dof];
      if (link.kind != recursive::JointKind::kFloating) {
        joint->setPosition(0, s.x[link.slot].q);
        joint->setVelocity(0, *qd);
        joint->setForce(0, *tau);
        continue;
      }
      const auto* x = &s.x[link.slot];
      Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
      X.linear() = Eigen::Quaterniond(x[3].q, x[4].q, x[5].q, x[6].q).normalized().matrix();
      X.translation() << x[0].q, x[1].q, x[2].q;
      joint->setPositions(dynamics::FreeJoint::convertToPositions(X));
      joint->setVelocities(otherPartFirst(qd));
      joint->setForces(otherPartFirst(tau));
    }
  }
  void step() override {
    skeleton_->computeForwardDynamics();
    skeleton_->integrateVelocities(h_);
    skeleton_->integratePositions(h_);
  }
  std::vector<double> positions() const override {
    std::vector<double> q(static_cast<std::size_t>(model_.positions));
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const recursive::LinkModel<double>& link = model_.links[i];
      const dynamics::Joint* joint = bodies_[i]->getParentJoint();
      double* to = &q[link.slot];
      if (link.kind != recursive::JointKind::kFloating) {
        *to = joint->getPosition(0);
        continue;
      }
      const Eigen::Isometry3d X = dynamics::FreeJoint::convertToTransform(joint->getPositions());
      const Eigen::Quaterniond turn(X.linear());
      const Eigen::Vector3d& p = X.translation();
      for (const double part : {p.x(), p.y(), p.z(), turn.w(), turn.x(), turn.y(), turn.z()})
        *to++ = part;
    }
    return q;
  }
  std::vector<double> rates() const override {
    std::vector<double> qd(static_cast<std::size_t>(model_.dof()));
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const recursive::LinkModel<double>& link = model_.links[i];
      const dynamics::Joint* joint = bodies_[i]->getParentJoint();
      if (link.kind != recursive::JointKind::kFloating) {
        qd[link.dof] = joint->getVelocity(0);
        continue;
      }
      const Eigen::Vector6d moved = otherPartFirst(joint->getVelocities().data());
      std::copy_n(moved.data(), 6, &qd[link.dof]);
    }
    return qd;
  }

 private:
  /// DART has the angular part first, the model the linear one.
  static Eigen::Vector6d otherPartFirst(const double* six) {
    Eigen::Vector6d out;
    out << six[3], six[4], six[5], six[0], six[1], six[2];
    return out;
  }

  template <typename Joint, typename Properties>
  void add(dynamics::BodyNode* parent, const std::string& name,
           const recursive::LinkModel<double>& link, Properties joint, Joint*) {
    joint.mName = "joint " + name;
    joint.mT_ParentBodyToJoint.linear() = link.X_tree.R.transpose();
    joint.mT_ParentBodyToJoint.translation() = link.X_tree.p;
    const recursive::RigidInertia<double>& m = link.M;
    Eigen::Matrix3d I;
    I << m.I.xx, m.I.xy, m.I.xz, m.I.xy, m.I.yy, m.I.yz, m.I.xz, m.I.yz, m.I.zz;
    const Eigen::Vector3d c = m.h / m.mass;
    dynamics::BodyNode::Properties body;
    body.mName = "body " + name;
    body.mInertia = dynamics::Inertia(
        m.mass, c,
        I - m.mass * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose()));
    bodies_.push_back(skeleton_->createJointAndBodyNodePair<Joint>(parent, joint, body).second);
  }

  recursive::Model<double> model_;
  dynamics::SkeletonPtr skeleton_;
  std::vector<dynamics::BodyNode*> bodies_;  ///< of the model's links
  double h_;
};

std::unique_ptr<RawSteps> makeSteps(const scene::Scene&, const recursive::Model<double>& model,
                                    const recursive::Constraints<double>&, const RawStep& step) {
  if (step.is_runge_kutta) throw std::invalid_argument("it has no Runge-Kutta method");
  return std::make_unique<DartSteps>(model, step.h);
}

}  // namespace
}  // namespace dynwitness::crosscheck

const dynwitness::crosscheck::RawEngine dynwitness_raw_engine = {
    nullptr, &dynwitness::crosscheck::makeSteps};
