// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/joint_quantities.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/inputs/features.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::crosscheck {
namespace {

using recursive::ArticulatedInertia;
using recursive::Transform;
using Matrix6 = recursive::Matrix6<double>;
using Six = recursive::Vector6<double>;
using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

constexpr const char* kNames[] = {"X", "M_i", "M_C", "M_A", "P", "PM", "Z", "F", "PF", "E", "beta"};
constexpr const char* kOfMotion[] = {"vx", "vy", "vz", "wx", "wy", "wz"};
constexpr const char* kOfForce[] = {"fx", "fy", "fz", "mx", "my", "mz"};

bool isMatrix(JointQuantity quantity) {
  return quantity <= JointQuantity::kPM;
}

/// Of entry (i, j): of blocks (linear, linear), (linear, angular), ...
std::string unitOf(JointQuantity quantity, int i, int j) {
  const int block = 2 * (i / 3) + j / 3;
  static constexpr const char *kMotion[] = {"1", "m", "1/m", "1"},
                              *kForce[] = {"1", "1/m", "m", "1"},
                              *kInertia[] = {"kg", "kg m", "kg m", "kg m^2"};
  if (quantity == JointQuantity::kX) return kMotion[block];
  return quantity == JointQuantity::kP ? kForce[block] : kInertia[block];
}

/// One joint of the scene and its parts in the model, the last first.
struct Joint {
  std::string name;
  std::size_t link, parent;       ///< of the scene
  std::vector<int> parts;         ///< links of the model; the first is the scene's link
  Transform<double> X_joint;      ///< that link's frame to the moved joint frame
  Transform<double> X_from;       ///< moved joint frame of the parent to its link's frame
  std::vector<std::string> axes;  ///< "rad" or "m", what a rate of each is of
};

/// Six by six numbers of a force map in A as one in B.
Matrix6 moved(const Transform<double>& X_BA, const Matrix6& map) {
  return X_BA.forceMatrix() * map * X_BA.inverse().forceMatrix();
}

}  // namespace

const char* name(JointQuantity quantity) {
  return kNames[static_cast<int>(quantity)];
}

std::optional<JointQuantity> jointQuantityNamed(const std::string& text) {
  for (int k = 0; k <= static_cast<int>(JointQuantity::kBeta); ++k)
    if (text == kNames[k]) return static_cast<JointQuantity>(k);
  return std::nullopt;
}

struct JointQuantities::Parts {
  Parts(const scene::Scene& of, JointAxes in)
      : scene(of),
        axes(of, in),
        number(of.mechanism),
        model(recursive::buildModel(of.mechanism, number, recursive::FixedJoints::kKept)),
        ws(model),
        cws(model, static_cast<int>(of.mechanism.acceleration_constraints.size())),
        I_C(model.links.size(), recursive::RigidInertia<double>::zero()),
        passed(model.links.size()),
        beta(model.links.size()) {}

  [[noreturn]] void refuse(const std::string& what) const {
    throw scene::InputError({scene.file.string(), 0}, what);
  }

  Joint joint(std::size_t i) const {
    const scene::Link& link = scene.mechanism.links[i];
    Joint out;
    out.name = link.joint.name;
    out.link = i;
    out.parent = static_cast<std::size_t>(link.parent);
    out.X_joint = model.joints[i].X;
    out.X_from = model.joints[static_cast<std::size_t>(link.parent)].X.inverse();
    const auto parts = recursive::detail::partsOf(link.joint.kind);
    for (int j = model.joints[i].link; out.parts.size() < parts.size();
         j = model.links[static_cast<std::size_t>(j)].parent)
      out.parts.push_back(j);
    for (const recursive::detail::JointPart& part : parts)
      for (int k = 0; k < recursive::axisCount(part.kind); ++k)
        out.axes.emplace_back(part.kind == recursive::JointKind::kPrismatic ||
                                      (part.kind == recursive::JointKind::kFloating && k < 3)
                                  ? "m"
                                  : "rad");
    return out;
  }

  const recursive::LinkModel<double>& link(int j) const {
    return model.links[static_cast<std::size_t>(j)];
  }
  const Transform<double>& up(int j) const { return ws.X_up[static_cast<std::size_t>(j)]; }

  /// Of one joint, row by row, in the axes of its moved frame.
  Eigen::MatrixXd of(const Joint& joint, JointQuantity quantity) const;
  /// In those asked for.
  Eigen::MatrixXd turned(const Joint& joint, JointQuantity quantity) const;
  /// Frame of the joint's part to that of its last one.
  Transform<double> toLast(const Joint& joint, std::size_t part) const {
    Transform<double> X = Transform<double>::identity();
    for (std::size_t k = 0; k < part; ++k) X = X * up(joint.parts[k]);
    return X;
  }
  Matrix6 projection(const Joint& joint) const;

  scene::Scene scene;
  TurnedAxes axes;
  scene::RealNumbers<double> number;
  recursive::Model<double> model;
  recursive::Workspace<double> ws;
  recursive::ConstraintWorkspace<double> cws;
  std::vector<recursive::RigidInertia<double>> I_C;
  std::vector<recursive::SweptProjection<double>> passed;
  std::vector<Eigen::VectorXd> beta;
  std::vector<Joint> joints;
};

JointQuantities::JointQuantities(const scene::Scene& scene, const std::vector<std::string>& joints,
                                 JointAxes axes)
    : parts_(std::make_unique<Parts>(scene, axes)) {
  requireTreated(scene, Command::kEvaluateJoints);
  std::vector<std::string> all;
  for (std::size_t i = 0; i < scene.mechanism.links.size(); ++i) {
    const scene::Link& link = scene.mechanism.links[i];
    if (link.parent < 0) continue;
    all.push_back(link.joint.name);
    if (joints.empty()) parts_->joints.push_back(parts_->joint(i));
  }
  for (const std::string& wanted : joints) {
    std::size_t i = 0;
    while (i < scene.mechanism.links.size() &&
           (scene.mechanism.links[i].parent < 0 || scene.mechanism.links[i].joint.name != wanted))
      ++i;
    if (i == scene.mechanism.links.size())
      parts_->refuse(
          fmt::format("--joint: no joint '{}', allowed: {}", wanted, fmt::join(all, ", ")));
    parts_->joints.push_back(parts_->joint(i));
  }
}
JointQuantities::~JointQuantities() = default;

std::vector<std::string> JointQuantities::columns(JointQuantity quantity) const {
  const std::string asked = name(quantity);
  const int m = parts_->cws.count();
  const bool of_constraints = quantity == JointQuantity::kE || quantity == JointQuantity::kBeta;
  if (of_constraints && m == 0)
    parts_->refuse(asked + ": the scene has no acceleration_constraint, expected one");
  std::vector<std::string> out;
  for (const Joint& joint : parts_->joints) {
    const std::string at = joint.name + "." + asked;
    const auto sixes = [&](std::size_t count, bool numbered, const char* const* components) {
      for (int row = 0; row < 6; ++row)
        for (std::size_t k = 1; k <= count; ++k)
          out.push_back(
              fmt::format("{}{}_{}", at, numbered ? std::to_string(k) : "", components[row]));
    };
    if (isMatrix(quantity))
      for (int i = 1; i <= 6; ++i)
        for (int j = 1; j <= 6; ++j) out.push_back(fmt::format("{}{}{}", at, i, j));
    else if (quantity == JointQuantity::kZ)
      sixes(joint.axes.size(), joint.axes.size() > 1, kOfMotion);
    else if (quantity == JointQuantity::kE)
      sixes(static_cast<std::size_t>(m), true, kOfForce);
    else if (quantity == JointQuantity::kBeta)
      for (int k = 1; k <= m; ++k) out.push_back(fmt::format("{}{}", at, k));
    else
      sixes(1, false, kOfForce);
  }
  if (out.empty()) parts_->refuse(asked + ": the joint is fixed and has no axis, expected one");
  return out;
}

std::vector<std::string> JointQuantities::units(JointQuantity quantity) const {
  // a constraint's unit force is 1 along its direction and 1 about its rotation
  std::vector<std::string> of_constraints;
  for (const auto& held : parts_->scene.mechanism.acceleration_constraints) {
    const auto isZero = [](const scene::Vector& v) {
      return std::all_of(v.begin(), v.end(), [](const auto& x) { return x.isLiteralZero(); });
    };
    of_constraints.emplace_back(isZero(held.direction) ? "rad" : "m");
  }
  std::vector<std::string> out;
  for (const Joint& joint : parts_->joints) {
    if (isMatrix(quantity)) {
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) out.push_back(unitOf(quantity, i, j));
    } else if (quantity == JointQuantity::kBeta) {
      for (const std::string& of : of_constraints) out.push_back(of + "/s^2");
    } else if (quantity == JointQuantity::kZ || quantity == JointQuantity::kE) {
      const bool is_axis = quantity == JointQuantity::kZ;
      for (int row = 0; row < 6; ++row)
        for (const std::string& of : is_axis ? joint.axes : of_constraints) {
          const bool linear = row < 3, of_turn = of == "rad";
          // m/rad or rad/m of an axis; N m/N or N/(N m) of a unit force
          out.emplace_back(linear != of_turn ? "1" : linear == is_axis ? "m" : "1/m");
        }
    } else {
      for (int row = 0; row < 6; ++row) out.emplace_back(row < 3 ? "N" : "N m");
    }
  }
  return out;
}

void JointQuantities::at(const scene::State<double>& state) {
  Parts& p = *parts_;
  p.axes.at(state);
  const std::size_t links = p.model.links.size();
  const auto n = static_cast<std::size_t>(p.model.dof());
  const std::vector<double> tau = state.tau.size() == n ? state.tau : std::vector<double>(n, 0.0);
  std::vector<double> qdd(n);
  const bool constrained = p.cws.count() > 0;
  std::vector<recursive::LinkConstraint<double>> held;
  if (constrained)
    held = recursive::accelerationConstraints(p.scene.mechanism, p.number, p.model, state.x,
                                              state.qd, p.ws);
  recursive::forwardDynamics(p.model, state.x, state.qd, tau, p.ws, qdd);
  if (constrained) recursive::propagateConstraints(p.model, held, p.ws, p.cws);
  for (std::size_t i = 0; i < links; ++i) {
    p.I_C[i] = p.model.links[i].M;
    p.beta[i] = Eigen::VectorXd::Zero(p.cws.count());
  }
  for (std::size_t i = links; i-- > 0;) {
    const recursive::LinkModel<double>& link = p.model.links[i];
    // what the link would take over of a parent that does not accelerate
    recursive::Motion<double> alpha = p.ws.c[i];
    for (int k = recursive::AnyJoints::axes(link) - 1; k >= 0; --k) {
      const auto d = static_cast<std::size_t>(link.dof + k);
      const double of_axis = (p.ws.u[d] - dot(alpha, p.ws.U[d])) / p.ws.D[d];
      recursive::AnyJoints::addMotion(link, k, of_axis, alpha);
    }
    p.passed[i] = recursive::sweptProjection(p.model, state.x, p.ws, static_cast<int>(i));
    if (link.parent < 0) continue;
    const auto parent = static_cast<std::size_t>(link.parent);
    p.I_C[parent] = p.I_C[parent] + p.ws.X_up[i].inverseTimes(p.I_C[i]);
    p.beta[parent] += p.beta[i] + p.cws.E[i].transpose() * alpha.vector();
  }
}

Matrix6 JointQuantities::Parts::projection(const Joint& joint) const {
  Matrix6 P = Matrix6::Identity();
  for (std::size_t k = 0; k < joint.parts.size(); ++k)
    P = moved(toLast(joint, k), passed[static_cast<std::size_t>(joint.parts[k])].P) * P;
  return joint.parts.empty() ? P : moved(joint.X_joint, P);
}

Eigen::MatrixXd JointQuantities::Parts::of(const Joint& joint, JointQuantity quantity) const {
  const int last = joint.parts.front();
  const auto at = static_cast<std::size_t>(last);
  const Transform<double> to_link = joint.X_joint.inverse();
  const auto inertia = [](const recursive::RigidInertia<double>& M) {
    return ArticulatedInertia<double>::fromRigid(M).matrix();
  };
  switch (quantity) {
    case JointQuantity::kX:
      return (joint.X_joint * toLast(joint, joint.parts.size()) * joint.X_from).motionMatrix();
    case JointQuantity::kM_i:
      return inertia(to_link.inverseTimes(model.links[at].M));
    case JointQuantity::kM_C:
      return inertia(to_link.inverseTimes(I_C[at]));
    case JointQuantity::kM_A:
      return to_link.inverseTimes(ws.M_A[at]).matrix();
    case JointQuantity::kP:
      return projection(joint);
    case JointQuantity::kPM: {
      const std::size_t first = joint.parts.size() - 1;
      const Transform<double> X = joint.X_joint * toLast(joint, first);
      return X.inverse()
          .inverseTimes(passed[static_cast<std::size_t>(joint.parts[first])].P_M)
          .matrix();
    }
    case JointQuantity::kZ: {
      Columns Z(6, joint.axes.size());
      Eigen::Index column = 0;
      for (std::size_t k = joint.parts.size(); k-- > 0;) {
        const recursive::LinkModel<double>& part = link(joint.parts[k]);
        for (int axis = 0; axis < recursive::axisCount(part.kind); ++axis)
          Z.col(column++) =
              (joint.X_joint * toLast(joint, k)).motionMatrix() * recursive::jointAxis(part, axis);
      }
      return Z;
    }
    case JointQuantity::kF:
      return (joint.X_joint * ws.f[at]).vector();
    case JointQuantity::kPF:
      return projection(joint) * (joint.X_joint * ws.f[at]).vector();
    case JointQuantity::kE:
      return joint.X_joint.forceMatrix() * cws.E[at];
    case JointQuantity::kBeta:
      return beta[at];
  }
  return {};
}

Eigen::MatrixXd JointQuantities::Parts::turned(const Joint& joint, JointQuantity quantity) const {
  const Eigen::MatrixXd one = of(joint, quantity);
  if (quantity == JointQuantity::kBeta) return one;  // has no axes
  const Matrix6 turn = axes.of(joint.link);
  if (!isMatrix(quantity)) return turn * one;
  return turn * one * (quantity == JointQuantity::kX ? axes.of(joint.parent) : turn).transpose();
}

Eigen::VectorXd JointQuantities::value(JointQuantity quantity) const {
  std::vector<double> out;
  for (const Joint& joint : parts_->joints) {
    const Eigen::MatrixXd one = parts_->turned(joint, quantity);
    for (Eigen::Index i = 0; i < one.rows(); ++i)
      for (Eigen::Index j = 0; j < one.cols(); ++j) out.push_back(one(i, j) + 0.0);  // not -0
  }
  return Eigen::Map<const Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

}  // namespace dynwitness::crosscheck
