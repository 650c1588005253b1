// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/joint_axes.hpp"

#include "recursive/build_model.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr const char* kAxesNames[] = {"link", "joint", "world"};

}  // namespace

const char* name(JointAxes axes) {
  return kAxesNames[static_cast<int>(axes)];
}

std::optional<JointAxes> jointAxesNamed(const std::string& text) {
  for (const JointAxes axes : {JointAxes::kLink, JointAxes::kJoint, JointAxes::kWorld})
    if (text == name(axes)) return axes;
  return std::nullopt;
}

TurnedAxes::TurnedAxes(const scene::Scene& scene, JointAxes axes)
    : axes_(axes),
      model_(recursive::buildModel(scene.mechanism, scene::RealNumbers<double>(scene.mechanism),
                                   recursive::FixedJoints::kKept)),
      R_W_(model_.links.size(), recursive::Matrix3<double>::Identity()) {
  for (const scene::Link& link : scene.mechanism.links) {
    parents_.push_back(link.parent);
    // of the scene: in the model joints of several axes are chains of such with one
    has_one_axis_.push_back(link.joint.kind == scene::JointKind::kRevolute ||
                            link.joint.kind == scene::JointKind::kPrismatic ||
                            link.joint.kind == scene::JointKind::kHelical);
  }
}

void TurnedAxes::at(const scene::State<double>& state) {
  if (axes_ != JointAxes::kWorld) return;
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    const recursive::LinkModel<double>& link = model_.links[i];
    R_W_[i] = recursive::AnyJoints::transform(link, state.x).R;
    if (link.parent >= 0) R_W_[i] = R_W_[i] * R_W_[static_cast<std::size_t>(link.parent)];
  }
}

recursive::Matrix6<double> TurnedAxes::of(std::size_t link) const {
  const recursive::ScenePlace<double>& joint = model_.joints[link];
  recursive::Matrix6<double> turn = recursive::Matrix6<double>::Identity();
  if (joint.link < 0 || axes_ == JointAxes::kLink) return turn;
  const auto at = static_cast<std::size_t>(joint.link);
  recursive::Matrix3<double> R = joint.X.R.transpose();  // to the model's link, z along its axis
  if (axes_ == JointAxes::kWorld) R = R_W_[at].transpose() * R;
  if (axes_ == JointAxes::kJoint && !has_one_axis_[link]) return turn;
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R;
  return turn;
}

Eigen::MatrixXd TurnedAxes::turned(const Eigen::MatrixXd& sixes) const {
  Eigen::MatrixXd out = sixes;
  Eigen::Index row = 0;
  for (std::size_t link = 0; link < parents_.size(); ++link) {
    if (parents_[link] < 0) continue;
    out.middleRows(row, 6) = of(link) * sixes.middleRows(row, 6);
    row += 6;
  }
  return out;
}

}  // namespace dynwitness::crosscheck
