// SPDX-License-Identifier: GPL-3.0-or-later
// In which axes six-vectors of joints are given: of the link, of the joint, of the world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "recursive/model.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** The point of a six-vector of a joint is the origin of the moved joint frame; its axes are
      kLink   those of that frame, which are the link's
      kJoint  the same, turned so that z lies along the axis of a joint with one (the chapter's
              frames, Z = (0, 0, 0, 0, 0, 1)); joints of other kinds: as kLink
      kWorld  the world's */
enum class JointAxes { kLink, kJoint, kWorld };
const char* name(JointAxes axes);  ///< "link", "joint", "world"
std::optional<JointAxes> jointAxesNamed(const std::string& name);

/// Turns what is given in the axes of moved joint frames into others.
class TurnedAxes {
 public:
  TurnedAxes(const scene::Scene& scene, JointAxes axes);

  JointAxes axes() const { return axes_; }
  void at(const scene::State<double>& state);
  /// From the axes of the frame that a link's joint moves to those asked for, for both parts of a
  /// six-vector; 1 for the root.
  recursive::Matrix6<double> of(std::size_t link) const;
  /// @param sixes  six entries a joint, in the order of links
  Eigen::MatrixXd turned(const Eigen::MatrixXd& sixes) const;

 private:
  JointAxes axes_;
  std::vector<int> parents_;        ///< of the scene's links
  std::vector<char> has_one_axis_;  ///< of their joints: revolute, prismatic or helical
  recursive::Model<double> model_;
  std::vector<recursive::Matrix3<double>> R_W_;  ///< world axes to those of the model's links
};

}  // namespace dynwitness::crosscheck
