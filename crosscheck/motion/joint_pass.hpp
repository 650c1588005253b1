// SPDX-License-Identifier: GPL-3.0-or-later
// What the sweeps make of the joints of a scene at one state, for any scalar.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/motion/joint_quantities.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/constraints.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::crosscheck {

/// One joint of the scene and its parts in a model that keeps fixed joints, the last part first.
template <typename T>
struct JointInModel {
  JointInModel(const scene::Mechanism& mechanism, const recursive::Model<T>& model, std::size_t i)
      : name(mechanism.links[i].joint.name),
        link(i),
        parent(static_cast<std::size_t>(mechanism.links[i].parent)),
        X_joint(model.joints[i].X),
        X_from(model.joints[parent].X.inverse()) {
    const auto of = recursive::detail::partsOf(mechanism.links[i].joint.kind);
    for (int j = model.joints[i].link; parts.size() < of.size();
         j = model.links[static_cast<std::size_t>(j)].parent)
      parts.push_back(j);
    for (const recursive::detail::JointPart& part : of)
      for (int k = 0; k < recursive::axisCount(part.kind); ++k)
        axes.emplace_back(part.kind == recursive::JointKind::kPrismatic ||
                                  (part.kind == recursive::JointKind::kFloating && k < 3)
                              ? "m"
                              : "rad");
  }

  std::string name;
  std::size_t link, parent;         ///< of the scene
  std::vector<int> parts;           ///< links of the model; the first is the scene's link
  recursive::Transform<T> X_joint;  ///< that link's frame to the moved joint frame
  recursive::Transform<T> X_from;   ///< moved joint frame of the parent to its link's frame
  std::vector<std::string> axes;    ///< "rad" or "m", what a rate of each is of
};

/** One pass of the sweeps, and what it says of each joint: JointQuantity, in the axes of the moved
    joint frame. @tparam T  tested with double, duals of doubles and duals over the prime field */
template <typename T>
class JointPass {
 public:
  using Matrix6 = recursive::Matrix6<T>;
  using Matrix = recursive::MatrixX<T>;

  /// @param model  built with FixedJoints::kKept @param constraints  how many on accelerations
  explicit JointPass(recursive::Model<T> model, int constraints = 0)
      : model_(std::move(model)),
        ws_(model_),
        cws_(model_, constraints),
        I_C_(model_.links.size(), recursive::RigidInertia<T>::zero()),
        passed_(model_.links.size()),
        beta_(model_.links.size()) {}

  const recursive::Model<T>& model() const { return model_; }
  recursive::Workspace<T>& workspace() { return ws_; }
  int constraints() const { return cws_.count(); }

  /// @param held  the constraints on accelerations at the state, as many as there are
  void run(const std::vector<scene::JointPosition<T>>& x, const std::vector<T>& qd,
           const std::vector<T>& tau, const std::vector<recursive::LinkConstraint<T>>& held = {});
  /// Of one joint, row by row, in the axes of its moved frame.
  Matrix of(const JointInModel<T>& joint, JointQuantity quantity) const;

 private:
  using Transform = recursive::Transform<T>;
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  /// Frame of the joint's part to that of its last one.
  Transform toLast(const JointInModel<T>& joint, std::size_t part) const {
    Transform X = Transform::identity();
    for (std::size_t k = 0; k < part; ++k) X = X * ws_.X_up[index(joint.parts[k])];
    return X;
  }
  Matrix6 projection(const JointInModel<T>& joint) const;
  Matrix axesOf(const JointInModel<T>& joint) const;
  Matrix6 inertia(const JointInModel<T>& joint, JointQuantity quantity) const;

  recursive::Model<T> model_;
  recursive::Workspace<T> ws_;
  recursive::ConstraintWorkspace<T> cws_;
  std::vector<recursive::RigidInertia<T>> I_C_;
  std::vector<recursive::SweptProjection<T>> passed_;
  std::vector<recursive::VectorX<T>> beta_;
};

template <typename T>
void JointPass<T>::run(const std::vector<scene::JointPosition<T>>& x, const std::vector<T>& qd,
                       const std::vector<T>& tau,
                       const std::vector<recursive::LinkConstraint<T>>& held) {
  std::vector<T> qdd(index(model_.dof()), T(0));
  recursive::forwardDynamics(model_, x, qd, tau, ws_, qdd);
  if (constraints() > 0) recursive::propagateConstraints(model_, held, ws_, cws_);
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    I_C_[i] = model_.links[i].M;
    beta_[i] = recursive::VectorX<T>::Constant(constraints(), T(0));
  }
  for (std::size_t i = model_.links.size(); i-- > 0;) {
    const recursive::LinkModel<T>& link = model_.links[i];
    // what the link would take over of a parent that does not accelerate
    recursive::Motion<T> alpha = ws_.c[i];
    for (int k = recursive::AnyJoints::axes(link) - 1; k >= 0; --k) {
      const std::size_t d = index(link.dof + k);
      const T of_axis = (ws_.u[d] - dot(alpha, ws_.U[d])) / ws_.D[d];
      recursive::AnyJoints::addMotion(link, k, of_axis, alpha);
    }
    passed_[i] = recursive::sweptProjection(model_, x, ws_, static_cast<int>(i));
    if (link.parent < 0) continue;
    const std::size_t parent = index(link.parent);
    I_C_[parent] = I_C_[parent] + ws_.X_up[i].inverseTimes(I_C_[i]);
    if (constraints() > 0) beta_[parent] += beta_[i] + cws_.E[i].transpose() * alpha.vector();
  }
}

template <typename T>
typename JointPass<T>::Matrix6 JointPass<T>::projection(const JointInModel<T>& joint) const {
  // six by six numbers of a force map in the frame of a part, in that of the moved joint
  const auto moved = [](const Transform& X_BA, const Matrix6& map) {
    return Matrix6(X_BA.forceMatrix() * map * X_BA.inverse().forceMatrix());
  };
  Matrix6 P = Matrix6::Identity();
  for (std::size_t k = 0; k < joint.parts.size(); ++k)
    P = (moved(toLast(joint, k), passed_[index(joint.parts[k])].P) * P).eval();
  return joint.parts.empty() ? P : moved(joint.X_joint, P);
}

template <typename T>
typename JointPass<T>::Matrix JointPass<T>::axesOf(const JointInModel<T>& joint) const {
  Matrix Z(6, static_cast<Eigen::Index>(joint.axes.size()));
  Eigen::Index column = 0;
  for (std::size_t k = joint.parts.size(); k-- > 0;) {
    const recursive::LinkModel<T>& part = model_.links[index(joint.parts[k])];
    for (int axis = 0; axis < recursive::axisCount(part.kind); ++axis)
      Z.col(column++) =
          (joint.X_joint * toLast(joint, k)).motionMatrix() * recursive::jointAxis(part, axis);
  }
  return Z;
}

template <typename T>
typename JointPass<T>::Matrix6 JointPass<T>::inertia(const JointInModel<T>& joint,
                                                     JointQuantity quantity) const {
  using Articulated = recursive::ArticulatedInertia<T>;
  const std::size_t at = index(joint.parts.front());
  const Transform to_link = joint.X_joint.inverse();
  if (quantity == JointQuantity::kM_i)
    return Articulated::fromRigid(to_link.inverseTimes(model_.links[at].M)).matrix();
  if (quantity == JointQuantity::kM_C)
    return Articulated::fromRigid(to_link.inverseTimes(I_C_[at])).matrix();
  if (quantity == JointQuantity::kM_A) return to_link.inverseTimes(ws_.M_A[at]).matrix();
  const std::size_t first = joint.parts.size() - 1;
  const Transform X = joint.X_joint * toLast(joint, first);
  return X.inverse().inverseTimes(passed_[index(joint.parts[first])].P_M).matrix();
}

template <typename T>
typename JointPass<T>::Matrix JointPass<T>::of(const JointInModel<T>& joint,
                                               JointQuantity quantity) const {
  const std::size_t at = index(joint.parts.front());
  switch (quantity) {
    case JointQuantity::kX:
      return (joint.X_joint * toLast(joint, joint.parts.size()) * joint.X_from).motionMatrix();
    case JointQuantity::kM_i:
    case JointQuantity::kM_C:
    case JointQuantity::kM_A:
    case JointQuantity::kPM:
      return inertia(joint, quantity);
    case JointQuantity::kP:
      return projection(joint);
    case JointQuantity::kZ:
      return axesOf(joint);
    case JointQuantity::kF:
      return (joint.X_joint * ws_.f[at]).vector();
    case JointQuantity::kPF:
      return projection(joint) * (joint.X_joint * ws_.f[at]).vector();
    case JointQuantity::kE:
      return joint.X_joint.forceMatrix() * cws_.E[at];
    case JointQuantity::kBeta:
      return beta_[at];
  }
  return {};
}

}  // namespace dynwitness::crosscheck
