// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/velocities.hpp"

#include <string>

namespace dynwitness::symbolic {

std::vector<Velocity> velocities(const BodyTree& tree) {
  static constexpr const char* kLetters[] = {"x", "y", "z"};
  Graph* graph = tree.graph();
  std::vector<Velocity> all;
  for (const Body& body : tree.bodies()) {
    const Joint& joint = body.joint;
    Velocity v{zeroVector(graph), zeroVector(graph), constant(graph, 0)};
    if (body.parent >= 0) v = all[body.parent];
    // as part of the parent, in the axes of the joint
    const Placed placed(graph, body.before);
    v.linear = placed.turned(v.linear + cross(v.angular, placed.p_AB));
    v.angular = placed.turned(v.angular);
    v.inboard = v.angular[joint.axis];  // the joint's own motion leaves its axis where it is
    // and with the joint's own motion
    for (const FrameStep& step : jointSteps(graph, joint)) {
      if (step.is_rotation) {
        v.angular = turned(step, v.angular);
        v.linear = turned(step, v.linear);
      } else {
        v.linear = v.linear + cross(v.angular, step.translation);
      }
    }
    for (const JointAxis& axis : jointAxes(graph, joint)) {
      if (axis.turns) v.angular[axis.coordinate] += axis.rate;
      if (axis.shifts)
        v.linear[axis.coordinate] += axis.turns ? joint.pitch * axis.rate : axis.rate;
    }
    const std::string number = std::to_string(all.size() + 1);
    for (int k = 0; k < 3; ++k) {
      graph->setName(v.angular[k].node, "omega" + number + kLetters[k]);
      graph->setName(v.linear[k].node, "v" + number + kLetters[k]);
    }
    all.push_back(v);
  }
  return all;
}

}  // namespace dynwitness::symbolic
