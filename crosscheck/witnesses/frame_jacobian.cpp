// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/frame_jacobian.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace dynwitness::crosscheck {

FramePoint farthestPoint(const scene::Mechanism& mechanism) {
  std::vector<int> joints(mechanism.links.size(), 0);  // that move the link
  FramePoint out;
  out.link = 0;
  for (std::size_t i = 1; i < mechanism.links.size(); ++i) {
    const scene::Link& link = mechanism.links[i];
    joints[i] = joints[static_cast<std::size_t>(link.parent)] +
                (scene::degreesOfFreedom(link.joint.kind) > 0 ? 1 : 0);
    if (joints[i] >= joints[static_cast<std::size_t>(out.link)]) out.link = static_cast<int>(i);
  }
  out.at = Eigen::Vector3d(0.125, -0.25, 0.375);
  return out;
}

std::string wordsOf(const FramePoint& point, const scene::Mechanism& mechanism) {
  return fmt::format("link '{}' at ({:g}, {:g}, {:g})",
                     mechanism.links[static_cast<std::size_t>(point.link)].name, point.at(0),
                     point.at(1), point.at(2));
}

std::vector<JacobianReading> otherReadings(const BoundedJacobian& jacobian) {
  struct Point {
    const char* words;
    Eigen::Vector3d at;
  };
  const Point points[] = {
      {"", jacobian.point},
      {"of the link's origin in place of the point", jacobian.origin},
      {"of the point of the link that passes the world's origin", Eigen::Vector3d::Zero()}};
  std::vector<JacobianReading> out;
  for (const bool opposite : {false, true})
    for (const Point& point : points)
      for (const bool in_link_axes : {false, true})
        for (const bool angular_first : {false, true}) {
          JacobianReading one{"", jacobian.value};
          const auto say = [&](bool holds, const std::string& words) {
            if (holds && !words.empty()) one.words += (one.words.empty() ? "" : ", ") + words;
          };
          const Eigen::Vector3d r = point.at - jacobian.point;
          if (*point.words != '\0')
            for (Eigen::Index j = 0; j < one.value.cols(); ++j)
              one.value.col(j).head<3>() += Eigen::Vector3d(one.value.col(j).tail<3>()).cross(r);
          if (in_link_axes) {
            const Eigen::Matrix3d back = jacobian.axes.transpose();
            one.value.topRows<3>() = (back * one.value.topRows<3>()).eval();
            one.value.bottomRows<3>() = (back * one.value.bottomRows<3>()).eval();
          }
          if (angular_first) {
            const Eigen::MatrixXd linear = one.value.topRows<3>();
            one.value.topRows<3>() = one.value.bottomRows<3>().eval();
            one.value.bottomRows<3>() = linear;
          }
          if (opposite) one.value = -one.value;
          say(true, point.words);
          say(in_link_axes, "in link axes");
          say(angular_first, "angular rows first");
          say(opposite, "with the opposite sign");
          if (!one.words.empty()) out.push_back(std::move(one));
        }
  return out;
}

}  // namespace dynwitness::crosscheck
