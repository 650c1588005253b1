// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/joint_quantities.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/joint_pass.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {
namespace {

using Matrix6 = recursive::Matrix6<double>;

constexpr const char* kJointNames[] = {"X", "M_i", "M_C", "M_A", "P",   "PM",
                                       "Z", "F",   "PF",  "E",   "beta"};
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

}  // namespace

const char* name(JointQuantity quantity) {
  return kJointNames[static_cast<int>(quantity)];
}

std::optional<JointQuantity> jointQuantityNamed(const std::string& text) {
  for (int k = 0; k <= static_cast<int>(JointQuantity::kBeta); ++k)
    if (text == kJointNames[k]) return static_cast<JointQuantity>(k);
  return std::nullopt;
}

struct JointQuantities::Parts {
  Parts(const scene::Scene& of, JointAxes in)
      : scene(of),
        axes(of, in),
        number(of.mechanism),
        pass(recursive::buildModel(of.mechanism, number, recursive::FixedJoints::kKept),
             static_cast<int>(of.mechanism.acceleration_constraints.size())) {}

  [[noreturn]] void refuse(const std::string& what) const {
    throw scene::InputError({scene.file.string(), 0}, what);
  }

  scene::Scene scene;
  TurnedAxes axes;
  scene::RealNumbers<double> number;
  JointPass<double> pass;
  std::vector<JointInModel<double>> joints;
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
    if (joints.empty()) parts_->joints.emplace_back(scene.mechanism, parts_->pass.model(), i);
  }
  for (const std::string& wanted : joints) {
    std::size_t i = 0;
    while (i < scene.mechanism.links.size() &&
           (scene.mechanism.links[i].parent < 0 || scene.mechanism.links[i].joint.name != wanted))
      ++i;
    if (i == scene.mechanism.links.size())
      parts_->refuse(
          fmt::format("--joint: no joint '{}', allowed: {}", wanted, fmt::join(all, ", ")));
    parts_->joints.emplace_back(scene.mechanism, parts_->pass.model(), i);
  }
}
JointQuantities::~JointQuantities() = default;

std::vector<std::string> JointQuantities::columns(JointQuantity quantity) const {
  const std::string asked = name(quantity);
  const int m = parts_->pass.constraints();
  const bool of_constraints = quantity == JointQuantity::kE || quantity == JointQuantity::kBeta;
  if (of_constraints && m == 0)
    parts_->refuse(asked + ": the scene has no acceleration_constraint, expected one");
  std::vector<std::string> out;
  for (const JointInModel<double>& joint : parts_->joints) {
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
  for (const JointInModel<double>& joint : parts_->joints) {
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
  const auto n = static_cast<std::size_t>(p.pass.model().dof());
  const std::vector<double> tau = state.tau.size() == n ? state.tau : std::vector<double>(n, 0.0);
  std::vector<recursive::LinkConstraint<double>> held;
  if (p.pass.constraints() > 0)
    held = recursive::accelerationConstraints(p.scene.mechanism, p.number, p.pass.model(), state.x,
                                              state.qd, p.pass.workspace());
  p.pass.run(state.x, state.qd, tau, held);
}

Eigen::VectorXd JointQuantities::arranged(
    JointQuantity quantity, const std::function<Eigen::MatrixXd(std::size_t)>& of) const {
  std::vector<double> out;
  for (std::size_t k = 0; k < parts_->joints.size(); ++k) {
    const JointInModel<double>& joint = parts_->joints[k];
    Eigen::MatrixXd one = of(k);
    if (quantity != JointQuantity::kBeta) {  // which has no axes
      const Matrix6 turn = parts_->axes.of(joint.link),
                    from = quantity == JointQuantity::kX ? parts_->axes.of(joint.parent) : turn;
      one = (turn * one).eval();
      if (isMatrix(quantity)) one = (one * from.transpose()).eval();
    }
    for (Eigen::Index i = 0; i < one.rows(); ++i)
      for (Eigen::Index j = 0; j < one.cols(); ++j) out.push_back(one(i, j) + 0.0);  // not -0
  }
  return Eigen::Map<const Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

Eigen::VectorXd JointQuantities::value(JointQuantity quantity) const {
  return arranged(quantity, [&](std::size_t k) -> Eigen::MatrixXd {
    return parts_->pass.of(parts_->joints[k], quantity);
  });
}

JointAxes JointQuantities::axes() const {
  return parts_->axes.axes();
}

std::vector<std::size_t> JointQuantities::links() const {
  std::vector<std::size_t> out;
  for (const JointInModel<double>& joint : parts_->joints) out.push_back(joint.link);
  return out;
}

}  // namespace dynwitness::crosscheck
