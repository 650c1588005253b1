// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/closures.hpp"

#include "symbolic/bodies.hpp"
#include "symbolic/quasi_velocities.hpp"

namespace dynwitness::symbolic {
namespace {

/// From the frame that the steps lead to, to the one that they start from.
void moveBack(const FrameSteps& steps, Placed* frame) {
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    if (!step->is_rotation) {
      frame->p_AB = step->translation + frame->p_AB;
      continue;
    }
    frame->p_AB = turnedBack(*step, frame->p_AB);
    for (Vector3& axis : frame->columns) axis = turnedBack(*step, axis);
  }
}

/// A frame in the world.
Placed placeOf(const scene::Attachment& at, BodyTree& tree) {
  Graph* graph = tree.graph();
  Placed frame(graph);
  moveBack(frameSteps(at.steps(), tree.number()), &frame);
  moveBack(tree.frame(at.link).offset, &frame);
  for (int k = tree.frame(at.link).body; k >= 0; k = tree.bodies()[k].parent) {
    moveBack(jointSteps(graph, tree.bodies()[k].joint), &frame);
    moveBack(tree.bodies()[k].before, &frame);
  }
  return frame;
}

/// phi of all closures, one after the other (scene::Closure has the equations).
std::vector<Value> closureResiduals(BodyTree& tree) {
  Graph* graph = tree.graph();
  std::vector<Value> phi;
  for (const scene::Closure& closure : tree.mechanism().closures) {
    const Placed a = placeOf(closure.a, tree), b = placeOf(closure.b, tree);
    const Vector3 d = b.p_AB + constant(graph, -1) * a.p_AB;
    if (closure.kind == scene::ClosureKind::kDistance) {
      const Value length = tree.number()(closure.length);
      phi.push_back(constant(graph, Rational(1, 2)) * (dot(d, d) - length * length));
      continue;
    }
    if (closure.kind == scene::ClosureKind::kPlane) {
      phi.push_back(dot(a.columns[2], d));
      continue;
    }
    const Value all[] = {dot(a.columns[0], d),
                         dot(a.columns[1], d),
                         dot(a.columns[2], d),
                         dot(a.columns[0], b.columns[2]),
                         dot(a.columns[1], b.columns[2]),
                         dot(a.columns[0], b.columns[1])};
    phi.insert(phi.end(), all, all + scene::equationCount(closure.kind));
  }
  return phi;
}

/// Functions of the position with their derivatives along the motion.
ClosureEquations differentiated(const std::vector<Value>& functions, Equations& e) {
  Graph& graph = e.graph;
  ClosureEquations closures;
  for (const Value& phi : functions) closures.phi.push_back(phi.node);
  std::vector<Node> phi_rate;
  for (const Node phi : closures.phi) {
    closures.J.push_back(positionGradient(e, phi));
    Node rate;
    for (int i = 0; i < e.dof(); ++i)
      rate =
          graph.add(rate, graph.multiply(closures.J.back()[i], graph.input(Input::kVelocity, i)));
    phi_rate.push_back(rate);
  }
  closures.gamma = graph.directionalDerivative(phi_rate, motion(e));
  return closures;
}

}  // namespace

ClosureEquations closureEquations(const scene::Mechanism& mechanism, const Options& options,
                                  Equations& e) {
  BodyTree tree(mechanism, options, &e.graph);
  return differentiated(closureResiduals(tree), e);
}

ClosureEquations frameEquations(const scene::Mechanism& mechanism, const Options& options,
                                const std::vector<scene::Attachment>& frames, Equations& e) {
  BodyTree tree(mechanism, options, &e.graph);
  std::vector<Value> components;
  for (const scene::Attachment& at : frames) {
    const Placed frame = placeOf(at, tree);
    for (const Vector3& v : {frame.p_AB, frame.columns[0], frame.columns[1], frame.columns[2]})
      components.insert(components.end(), v.begin(), v.end());
  }
  return differentiated(components, e);
}

}  // namespace dynwitness::symbolic
