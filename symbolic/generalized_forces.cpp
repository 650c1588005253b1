// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/generalized_forces.hpp"

#include <algorithm>
#include <vector>

#include "symbolic/velocities.hpp"

namespace dynwitness::symbolic {

Value wrenchPower(BodyTree& tree) {
  Graph* graph = tree.graph();
  NodeNumbers& number = tree.number();
  const std::vector<Body>& bodies = tree.bodies();
  Value power = constant(graph, 0);
  const std::vector<Velocity> v = velocities(tree);
  for (const scene::Wrench& wrench : tree.mechanism().wrenches) {
    const LinkFrame& frame = tree.frame(wrench.link);
    if (frame.body < 0) continue;  // the world does not move
    Vector3 force = number.vector(wrench.force), moment = number.vector(wrench.moment),
            at = number.vector(wrench.at);
    const Placed placed(graph, frame.offset);
    at = placed.p_AB + placed.turnedBack(at);
    if (wrench.axes == scene::Wrench::Axes::kLink) {
      force = placed.turnedBack(force);
      moment = placed.turnedBack(moment);
    } else {
      std::vector<int> path;  // from the world to the body
      for (int k = frame.body; k >= 0; k = bodies[k].parent) path.push_back(k);
      std::reverse(path.begin(), path.end());
      for (int k : path) {
        const Placed at_zero(graph, bodies[k].before);
        force = at_zero.turned(force);
        moment = at_zero.turned(moment);
        for (const FrameStep& step : jointSteps(graph, bodies[k].joint)) {
          if (!step.is_rotation) continue;
          force = turned(step, force);
          moment = turned(step, moment);
        }
      }
    }
    const Velocity& body = v[frame.body];
    power += dot(force, body.linear + cross(body.angular, at)) + dot(moment, body.angular);
  }
  return power;
}

Value dissipation(BodyTree& tree) {
  Graph* graph = tree.graph();
  NodeNumbers& number = tree.number();
  const Value half = constant(graph, Rational(1, 2));
  Value R = constant(graph, 0);
  for (std::size_t i = 0; i < tree.mechanism().links.size(); ++i) {
    const scene::Friction& friction = tree.mechanism().links[i].joint.friction;
    if (friction.isNone()) continue;
    const Joint& joint = tree.bodies()[tree.frame(static_cast<int>(i)).body].joint;
    Value qd = input(graph, Input::kVelocity, joint.rate);
    Value sign = input(graph, Input::kDirection, joint.rate);
    if (joint.follows) {
      qd = joint.ratio * qd;
      if (graph->value(joint.ratio.node) < 0) sign = -sign;
    }
    const Value positive = number(friction.positive), negative = number(friction.negative);
    R += half * number(friction.viscous) * (qd * qd);
    // positive at sign 1, -negative at sign -1, 0 at 0
    R += half * ((positive + negative) * sign + (positive - negative) * (sign * sign)) * qd;
  }
  return R;
}

}  // namespace dynwitness::symbolic
