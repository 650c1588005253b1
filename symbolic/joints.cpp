// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/joints.hpp"

#include <array>

namespace dynwitness::symbolic {

FrameSteps jointSteps(Graph* graph, const Joint& joint) {
  FrameSteps steps;
  if (!joint.hasOneRate()) {
    if (joint.kind == Joint::Kind::kFree)
      steps.push_back(FrameStep::shift({input(graph, Input::kPosition, joint.slot),
                                        input(graph, Input::kPosition, joint.slot + 1),
                                        input(graph, Input::kPosition, joint.slot + 2)}));
    std::array<Vector3, 3> columns;
    for (int row = 0; row < 3; ++row)
      for (int j = 0; j < 3; ++j)
        columns[j][row] = input(graph, Input::kRotation, rotationEntry(joint.quaternion(), row, j));
    steps.push_back(FrameStep::rotation(columns));
    return steps;
  }
  if (joint.turns()) {
    const Value c = input(graph, Input::kCos, joint.slot),
                s = input(graph, Input::kSin, joint.slot);
    steps.push_back(FrameStep::rotation(joint.axis, c, joint.reversed ? -s : s));
  }
  if (joint.kind != Joint::Kind::kTurn) {
    const Value q = input(graph, Input::kPosition, joint.slot), along = joint.reversed ? -q : q;
    Vector3 shift = zeroVector(graph);
    shift[joint.axis] = joint.kind == Joint::Kind::kScrew ? joint.pitch * along : along;
    steps.push_back(FrameStep::shift(shift));
  }
  return steps;
}

Value stretch(Graph* graph, const Joint& joint) {
  return input(graph, Input::kPosition, joint.slot) - joint.rest;
}

std::vector<JointAxis> jointAxes(Graph* graph, const Joint& joint) {
  std::vector<JointAxis> axes;
  for (int k = 0; k < joint.rates(); ++k) {
    Value qd = input(graph, Input::kVelocity, joint.rate + k);
    if (joint.follows) qd = joint.ratio * qd;
    if (joint.hasOneRate()) {
      const bool shifts = joint.kind == Joint::Kind::kSlide || joint.kind == Joint::Kind::kScrew;
      axes.push_back({joint.axis, joint.turns(), shifts, joint.reversed ? -qd : qd});
    } else {
      const bool shifts = k + 3 < joint.rates();
      axes.push_back({k % 3, !shifts, shifts, qd});
    }
  }
  return axes;
}

std::vector<Direction> jointDirections(Graph* graph, const Joint& joint) {
  if (joint.follows) return {};
  if (joint.hasOneRate()) {
    const Variable q{Input::kPosition, joint.slot};
    return {Direction{{q, graph->constant(1)}}};
  }
  std::vector<Direction> directions;
  const std::array<Vector3, 3> R = jointSteps(graph, joint).back().columns;
  if (joint.kind == Joint::Kind::kFree) {  // dp/dt = R v
    for (int k = 0; k < 3; ++k) {
      directions.emplace_back();
      for (int row = 0; row < 3; ++row)
        directions.back().push_back({{Input::kPosition, joint.slot + row}, R[k][row].node});
    }
  }
  for (int k = 0; k < 3; ++k) {  // dR/dt = R [e_k]x: the next column moves to the one after it
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    directions.emplace_back();
    for (int row = 0; row < 3; ++row) {
      const auto entry = [&](int j) {
        return Variable{Input::kRotation, rotationEntry(joint.quaternion(), row, j)};
      };
      directions.back().push_back({entry(next), R[last][row].node});
      directions.back().push_back({entry(last), (-R[next][row]).node});
    }
  }
  return directions;
}

}  // namespace dynwitness::symbolic
