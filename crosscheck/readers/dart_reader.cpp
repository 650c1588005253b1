// SPDX-License-Identifier: GPL-3.0-or-later
// DART as a reader of robot descriptions: the user's bytes, DartLoader as it is made. Its defaults
// are a root that floats, and 1 kg for a link without <inertial>.
//
// This file must not be compiled with -march=native (witnesses/dart.cpp).
#include "crosscheck/readers/reader.hpp"

#ifdef DYNWITNESS_HAS_DART
#include <dart/config.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/DegreeOfFreedom.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PlanarJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/utils/urdf/DartLoader.hpp>

#include <malloc.h>

#include <cmath>
#include <limits>
#include <map>

#include "crosscheck/readers/one_line.hpp"
#include "crosscheck/witnesses/hushed.hpp"
#endif

namespace dynwitness::crosscheck {

#ifdef DYNWITNESS_HAS_DART
namespace {

using dart::dynamics::BodyNode;
using dart::dynamics::SkeletonPtr;
namespace joints = dart::dynamics;

/// @return false: a joint that does not move
bool readJoint(const joints::Joint& joint, ReadBody* out) {
  out->joint = joint.getName();
  if (dynamic_cast<const joints::WeldJoint*>(&joint)) return false;
  out->axis.setZero();
  if (dynamic_cast<const joints::FreeJoint*>(&joint)) {
    out->kind = scene::JointKind::kFloating;
    return true;
  }
  if (dynamic_cast<const joints::PlanarJoint*>(&joint)) {
    out->kind = scene::JointKind::kPlanar;
    return true;
  }
  if (const auto* revolute = dynamic_cast<const joints::RevoluteJoint*>(&joint)) {
    out->kind = scene::JointKind::kRevolute;
    out->axis = revolute->getAxis();
  } else if (const auto* prismatic = dynamic_cast<const joints::PrismaticJoint*>(&joint)) {
    out->kind = scene::JointKind::kPrismatic;
    out->axis = prismatic->getAxis();
  } else {
    out->kind = scene::JointKind::kUniversal;
    return true;
  }
  const joints::DegreeOfFreedom& dof = *joint.getDof(0);
  if (std::isfinite(dof.getPositionLowerLimit())) out->lower = dof.getPositionLowerLimit();
  if (std::isfinite(dof.getPositionUpperLimit())) out->upper = dof.getPositionUpperLimit();
  out->damping = dof.getDampingCoefficient();
  out->friction = dof.getCoulombFriction();
  out->stiffness = dof.getSpringStiffness();
  out->rest = dof.getRestPosition();
  if (joint.getActuatorType() == joints::Joint::MIMIC && joint.getMimicJoint()) {
    out->leader = joint.getMimicJoint()->getName();
    out->multiplier = joint.getMimicMultiplier();
    out->offset = joint.getMimicOffset();
  }
  return true;
}

Robot robotOf(const SkeletonPtr& skeleton, std::vector<std::size_t>* dofs, bool* floats) {
  Robot robot;
  robot.gravity = skeleton->getGravity();
  struct Carrier {
    int body = -1;
    Eigen::Isometry3d from = Eigen::Isometry3d::Identity();
  };
  std::map<const BodyNode*, Carrier> carriers;
  for (std::size_t i = 0; i < skeleton->getNumBodyNodes(); ++i) {
    const BodyNode* node = skeleton->getBodyNode(i);
    const joints::Joint* joint = node->getParentJoint();
    const Carrier parent =
        node->getParentBodyNode() ? carriers[node->getParentBodyNode()] : Carrier();
    const Eigen::Isometry3d X = parent.from * joint->getTransformFromParentBodyNode();
    const Eigen::Isometry3d from_joint = joint->getTransformFromChildBodyNode().inverse();
    ReadBody body;
    body.link = node->getName();
    Carrier here = parent;
    if (!node->getParentBodyNode() && dynamic_cast<const joints::FreeJoint*>(joint)) {
      *floats = true;  // held here: a convention
      here.from = X * from_joint;
    } else if (readJoint(*joint, &body)) {
      body.parent = parent.body;
      body.placement = X;
      here = {static_cast<int>(robot.bodies.size()), from_joint};
      dofs->push_back(joint->getNumDofs() == 1 ? joint->getIndexInSkeleton(0) : std::size_t(-1));
      robot.bodies.push_back(body);
    } else {
      here.from = X * from_joint;
    }
    carriers[node] = here;
    if (here.body < 0) continue;
    const joints::Inertia& inertia = node->getInertia();
    robot.bodies[static_cast<std::size_t>(here.body)].moments +=
        MassMoments::of(inertia.getMass(), inertia.getLocalCOM(), inertia.getMoment())
            .movedBy(here.from);
  }
  return robot;
}

Reading read(const std::string& text, const std::filesystem::path& file) {
  // it makes and drops a matrix of n x n with every body that it adds: the heap keeps their pages
  constexpr int kBytes = 1 << 25;  // the most that may be asked for
  mallopt(M_MMAP_THRESHOLD, kBytes);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  Reading reading;
  SkeletonPtr skeleton;
  std::string heard;
  try {
    const Hushed hushed;
    dart::utils::DartLoader loader;
    std::error_code ignored;
    skeleton = loader.parseSkeletonString(
        text, "file://" + std::filesystem::absolute(file, ignored).string());
    heard = inOneLine(hushed.text());
  } catch (const std::exception& error) {
    reading.refusal = error.what();
    return reading;
  }
  if (!skeleton) {
    reading.refusal = heard.empty() ? "it gives no reason" : heard;
    return reading;
  }
  std::vector<std::size_t> dofs;
  bool floats = false;
  reading.robot = robotOf(skeleton, &dofs, &floats);
  if (floats) reading.told.push_back("the root floats, as by default; it is held here");
  reading.answer = [skeleton, dofs](const std::vector<double>& q) {
    skeleton->resetPositions();
    skeleton->resetVelocities();
    for (std::size_t k = 0; k < dofs.size(); ++k) {
      if (dofs[k] == std::size_t(-1))
        throw std::logic_error("dart_reader: a joint of several degrees of freedom");
      skeleton->setPosition(dofs[k], q[k]);
    }
    const Eigen::MatrixXd& M = skeleton->getMassMatrix();
    const Eigen::VectorXd& g = skeleton->getGravityForces();
    const auto n = static_cast<Eigen::Index>(dofs.size());
    MassAndGravity out{Eigen::MatrixXd(n, n), Eigen::VectorXd(n), {}, {}};
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto a = static_cast<Eigen::Index>(dofs[static_cast<std::size_t>(i)]);
      out.g[i] = g[a];
      for (Eigen::Index j = 0; j < n; ++j)
        out.M(i, j) = M(a, static_cast<Eigen::Index>(dofs[static_cast<std::size_t>(j)]));
    }
    return out;
  };
  return reading;
}

}  // namespace

Reader dartReader() {
  return {"dart", DART_VERSION, true, read};
}
#else
Reader dartReader() {
  return {"dart", "", false, {}};
}
#endif

}  // namespace dynwitness::crosscheck
