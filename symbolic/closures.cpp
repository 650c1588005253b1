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

/// What an equation says is zero: a function of the position, or one of rates, linear in them.
struct Asked {
  Value function;
  bool of_rates = false;
};

/// Where b's origin is, seen from a and in a's axes, and b's axes there.
Placed seenFrom(const Placed& a, const Placed& b) {
  Graph* graph = b.p_AB[0].graph;
  Placed seen(graph);
  const Vector3 d = b.p_AB + constant(graph, -1) * a.p_AB;
  for (std::size_t i = 0; i < 3; ++i) {
    seen.p_AB[i] = dot(a.columns[i], d);
    for (std::size_t k = 0; k < 3; ++k) seen.columns[k][i] = dot(a.columns[i], b.columns[k]);
  }
  return seen;
}

/// How the components of a place change along the motion.
Placed rateOf(const Placed& place, Equations& e) {
  std::vector<Node> components;
  for (const Vector3& v : {place.p_AB, place.columns[0], place.columns[1], place.columns[2]})
    for (const Value& x : v) components.push_back(x.node);
  const std::vector<Node> rates = e.graph.directionalDerivative(components, motion(e));
  Placed out(&e.graph);
  for (std::size_t i = 0; i < 3; ++i) {
    out.p_AB[i].node = rates[i];
    for (std::size_t k = 0; k < 3; ++k) out.columns[k][i].node = rates[3 + 3 * k + i];
  }
  return out;
}

/** A disc of this radius about z_b on a's xy plane. The point of it that touches, s in b's axes, is
    at d + (x_b y_b z_b) s seen from a; s is fixed on the disc while the rate of that is taken. */
std::vector<Asked> rolling(const Placed& b_in_a, const Value& radius, Equations& e) {
  Graph* graph = &e.graph;
  const Value one = constant(graph, 1), height = b_in_a.p_AB[2], lean = b_in_a.columns[2][2];
  const Value reach = radius * radius / height;  // r^2 / h
  Vector3 s;  // -(n - (n . z_b) z_b) r^2 / h: n has the components (x_b, y_b, z_b) . n in b's axes
  for (std::size_t k = 0; k < 2; ++k) s[k] = -(b_in_a.columns[k][2] * reach);
  const Placed rate = rateOf(b_in_a, e);
  std::vector<Asked> asked;
  for (std::size_t i = 0; i < 2; ++i)
    asked.push_back({rate.p_AB[i] + s[0] * rate.columns[0][i] + s[1] * rate.columns[1][i], true});
  asked.push_back({constant(graph, Rational(1, 2)) * (height - (one - lean * lean) * reach)});
  return asked;
}

/// All closures, one after the other (scene::Closure has the equations).
std::vector<Asked> closureResiduals(BodyTree& tree, Equations& e) {
  Graph* graph = tree.graph();
  std::vector<Asked> asked;
  for (const scene::Closure& closure : tree.mechanism().closures) {
    const Placed a = placeOf(closure.a, tree), b = placeOf(closure.b, tree);
    if (closure.kind == scene::ClosureKind::kDistance) {
      const Vector3 d = b.p_AB + constant(graph, -1) * a.p_AB;
      const Value length = tree.number()(closure.length);
      asked.push_back({constant(graph, Rational(1, 2)) * (dot(d, d) - length * length)});
      continue;
    }
    const Placed b_in_a = seenFrom(a, b);
    if (closure.kind == scene::ClosureKind::kPlane) {
      asked.push_back({b_in_a.p_AB[2]});
      continue;
    }
    if (closure.kind == scene::ClosureKind::kSkate) {
      asked.push_back({dot(b_in_a.columns[1], rateOf(b_in_a, e).p_AB), true});
      continue;
    }
    if (closure.kind == scene::ClosureKind::kRolling) {
      for (const Asked& one : rolling(b_in_a, tree.number()(closure.length), e))
        asked.push_back(one);
      continue;
    }
    const Value all[] = {b_in_a.p_AB[0],       b_in_a.p_AB[1],       b_in_a.p_AB[2],
                         b_in_a.columns[2][0], b_in_a.columns[2][1], b_in_a.columns[1][0]};
    for (int k = 0; k < scene::equationCount(closure.kind); ++k) asked.push_back({all[k]});
  }
  return asked;
}

/// What is asked with its derivatives along the motion.
ClosureEquations differentiated(const std::vector<Asked>& asked, Equations& e, bool with_gamma) {
  Graph& graph = e.graph;
  ClosureEquations closures;
  std::vector<Variable> rates;
  for (int i = 0; i < e.dof(); ++i) rates.push_back({Input::kVelocity, i});
  std::vector<Node> rate_of_each;
  for (const Asked& one : asked) {
    if (one.of_rates) {
      closures.phi.push_back(Node{});
      closures.J.push_back(graph.gradient(one.function.node, rates));
      rate_of_each.push_back(one.function.node);
      continue;
    }
    closures.phi.push_back(one.function.node);
    closures.J.push_back(positionGradient(e, one.function.node));
    if (!with_gamma) continue;
    Node rate;
    for (int i = 0; i < e.dof(); ++i)
      rate =
          graph.add(rate, graph.multiply(closures.J.back()[i], graph.input(Input::kVelocity, i)));
    rate_of_each.push_back(rate);
  }
  if (with_gamma) closures.gamma = graph.directionalDerivative(rate_of_each, motion(e));
  return closures;
}

}  // namespace

ClosureEquations closureEquations(const scene::Mechanism& mechanism, const Options& options,
                                  Equations& e, bool with_gamma) {
  if (mechanism.closures.empty()) return {};
  BodyTree tree(mechanism, options, &e.graph);
  return differentiated(closureResiduals(tree, e), e, with_gamma);
}

ClosureEquations frameEquations(const scene::Mechanism& mechanism, const Options& options,
                                const std::vector<scene::Attachment>& frames, Equations& e,
                                bool with_gamma) {
  if (frames.empty()) return {};
  BodyTree tree(mechanism, options, &e.graph);
  std::vector<Asked> components;
  for (const scene::Attachment& at : frames) {
    const Placed frame = placeOf(at, tree);
    for (const Vector3& v : {frame.p_AB, frame.columns[0], frame.columns[1], frame.columns[2]})
      for (const Value& x : v) components.push_back({x});
  }
  return differentiated(components, e, with_gamma);
}

}  // namespace dynwitness::symbolic
