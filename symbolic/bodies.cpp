// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/bodies.hpp"

#include <stdexcept>
#include <utility>

namespace dynwitness::symbolic {
namespace {

/// What one of the joints does that a joint of a scene is made of, and along which axis of the
/// joint frame.
struct Part {
  Joint::Kind kind;
  int axis;
};

std::vector<Part> partsOf(scene::JointKind kind) {
  using scene::JointKind;
  using Kind = Joint::Kind;
  switch (kind) {
    case JointKind::kFixed:
      return {};
    case JointKind::kRevolute:
      return {{Kind::kTurn, 2}};
    case JointKind::kPrismatic:
      return {{Kind::kSlide, 2}};
    case JointKind::kHelical:
      return {{Kind::kScrew, 2}};
    case JointKind::kCylindrical:
      return {{Kind::kSlide, 2}, {Kind::kTurn, 2}};
    case JointKind::kUniversal:
      return {{Kind::kTurn, 0}, {Kind::kTurn, 1}};
    case JointKind::kPlanar:
      return {{Kind::kSlide, 0}, {Kind::kSlide, 1}, {Kind::kTurn, 2}};
    case JointKind::kSpherical:
      return {{Kind::kBall, 2}};
    case JointKind::kFloating:
      return {{Kind::kFree, 2}};
  }
  throw std::logic_error("BodyTree: unknown kind of joint");
}

/// Rz(alpha) Ry(beta), which takes z to an axis.
FrameSteps axisSteps(const scene::AxisTurn<Value>& turn) {
  return {FrameStep::rotation(2, turn.alpha.c, turn.alpha.s),
          FrameStep::rotation(1, turn.beta.c, turn.beta.s)};
}

/// The same for an axis that lies along a coordinate axis: by quarter turns.
FrameSteps axisSteps(Graph* graph, const NodeNumbers::AlongCoordinate& along) {
  FrameSteps steps;
  const auto quarters = [&](int about, int count) {
    const auto turn = scene::quarterTurns<int>(count);
    if (count != 0)
      steps.push_back(FrameStep::rotation(about, constant(graph, turn.c), constant(graph, turn.s)));
  };
  if (along.coordinate == 0) quarters(2, along.reversed ? 2 : 0);
  if (along.coordinate == 1) quarters(2, along.reversed ? -1 : 1);
  quarters(1, along.coordinate != 2 ? 1 : along.reversed ? 2 : 0);
  return steps;
}

void append(FrameSteps* to, const FrameSteps& more) {
  to->insert(to->end(), more.begin(), more.end());
}

}  // namespace

BodyTree::BodyTree(const scene::Mechanism& mechanism, const Options& options, Graph* graph)
    : mechanism_(mechanism),
      graph_(graph),
      number_(mechanism, options.fold_parameters, graph),
      followers_(scene::followers(mechanism)),
      world_(noMass(graph)) {
  // symbols in the order in which the scene declares them
  if (!options.fold_parameters)
    for (const scene::Parameter& p : mechanism.parameters) number_(scene::Number::parse(p.name));
  gravity_ = mechanism.has_gravity ? number_.vector(mechanism.gravity) : zeroVector(graph);

  for (const scene::Link& link : mechanism.links) {
    LinkFrame frame{-1, {}};
    if (link.parent >= 0) frame = frames_[link.parent];
    append(&frame.offset, frameSteps(link.joint.placement.beforeJoint(), number_));
    frame.offset = shortened(graph_, std::move(frame.offset));
    if (scene::degreesOfFreedom(link.joint.kind) > 0) addBodies(link, &frame);
    append(&frame.offset, frameSteps(link.joint.placement.afterJoint(), number_));
    const MassMoments moments = movedBack(frame.offset, linkMoments(link.inertia, number_));
    MassMoments& carrier = momentsOf(frame.body);
    carrier = carrier + moments;
    frames_.push_back(frame);
  }
  if (options.regroup_inertias) regroup();
}

/// The link that a joint carries, and the massless ones between the parts of the joint.
void BodyTree::addBodies(const scene::Link& link, LinkFrame* frame) {
  const scene::Joint& given = link.joint;
  const std::vector<Part> parts = partsOf(given.kind);
  const std::vector<std::string>& rates = scene::rateNames(given.kind);
  const Value gear = number_(given.gear_ratio), rotor = gear * gear * number_(given.rotor_inertia);
  const Value spin = given.gyroscopic ? gear * number_(given.rotor_inertia) : constant(graph_, 0);
  addRotors(given, *frame);
  FrameSteps to_axis;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    Joint joint{};
    joint.name = given.name;
    if (parts.size() > 1) joint.name += "." + rates[k];
    joint.kind = parts[k].kind;
    joint.axis = parts[k].axis;
    joint.rotor = rotor;
    joint.spin = spin;
    joint.stiffness = number_(given.stiffness);
    joint.rest = number_(given.rest);
    joint.pitch = number_(given.pitch);
    joint.ratio = constant(graph_, 1);
    joint.rate = rates_;
    joint.slot = slots_;
    slots_ += joint.slots();
    if (given.mimic) {
      const scene::Follower& f = followers_[next_follower_++];
      joint.follows = true;
      joint.rate = f.rate;
      joint.ratio = constant(graph_, f.multiplier);
    } else {
      rates_ += joint.rates();
    }
    if (k == 0 && scene::hasAxis(given.kind)) {
      const NodeNumbers::AlongCoordinate along = number_.alongCoordinate(given.axis);
      const bool upright = given.kind == scene::JointKind::kPlanar;  // which x and y are matters
      if (along.coordinate < 0) {
        to_axis = axisSteps(number_.axisTurn(given.axis, size() + 1));
      } else if (upright) {
        to_axis = axisSteps(graph_, along);
      } else {
        joint.axis = along.coordinate;
        joint.reversed = along.reversed;
      }
    } else if (given.kind == scene::JointKind::kCylindrical) {
      joint.axis = bodies_.back().joint.axis;
      joint.reversed = bodies_.back().joint.reversed;
    }
    Body body{link.name, frame->body, frame->offset, joint, noMass(graph_)};
    if (k + 1 < parts.size()) body.name += "." + rates[k];
    if (k == 0) append(&body.before, to_axis);
    *frame = {size(), {}};
    bodies_.push_back(body);
  }
  frame->offset = inverseTurns(to_axis);
  for (std::size_t k = rotors_.size() - given.rotors.size(); k < rotors_.size(); ++k)
    rotors_[k].body = size() - 1;
}

/// Before the joint's bodies are there. @param frame  that of the joint, before its motion
void BodyTree::addRotors(const scene::Joint& joint, const LinkFrame& frame) {
  for (const scene::Rotor& given : joint.rotors) {
    GearedRotor rotor{-1, rates_, {}, number_(given.inertia), -1, zeroVector(graph_)};
    for (const scene::Number& n : given.ratio) rotor.ratio.push_back(number_(n));
    if (given.axis && frame.body >= 0) {
      const NodeNumbers::AlongCoordinate along = number_.alongCoordinate(*given.axis);
      // its letters are no body's
      const int label =
          3 * static_cast<int>(mechanism_.links.size()) + static_cast<int>(rotors_.size()) + 1;
      FrameSteps to_axis = frame.offset;
      append(&to_axis, along.coordinate < 0 ? axisSteps(number_.axisTurn(*given.axis, label))
                                            : axisSteps(graph_, along));
      rotor.carrier = frame.body;
      rotor.axis = Placed(graph_, to_axis).columns[2];
    }
    rotors_.push_back(rotor);
  }
}

void BodyTree::regroup() {
  const Value zero = constant(graph_, 0);
  for (int i = size() - 1; i >= 0; --i) {
    Body& body = bodies_[i];
    MassMoments& own = body.moments;
    MassMoments inboard = noMass(graph_);
    if (body.joint.kind == Joint::Kind::kTurn) {
      // a mass distribution that looks the same from all sides of the axis, without inertia about
      // the axis itself, does not notice whether it turns with the joint
      const int x = (body.joint.axis + 1) % 3, y = (body.joint.axis + 2) % 3, z = body.joint.axis;
      inboard.mass = own.mass;
      inboard.first[z] = own.first[z];
      inboard.second(x, x) = inboard.second(y, y) = own.second(y, y);
      own.mass = own.first[z] = zero;
      own.second(x, x) -= inboard.second(x, x);
      own.second(y, y) = zero;
    } else if (body.joint.kind == Joint::Kind::kSlide) {
      // a slider turns as its inboard body does
      inboard.second = own.second;
      own.second = zeroMatrix(graph_);
    } else {
      continue;
    }
    inboard = movedBack(body.before, inboard);
    MassMoments& carrier = momentsOf(body.parent);
    carrier = carrier + inboard;
  }
}

Value rotorRate(Graph* graph, const GearedRotor& rotor) {
  Value rate = constant(graph, 0);
  for (std::size_t k = 0; k < rotor.ratio.size(); ++k)
    rate += rotor.ratio[k] * input(graph, Input::kVelocity, rotor.rate + static_cast<int>(k));
  return rate;
}

std::vector<Direction> directions(const BodyTree& tree) {
  std::vector<Direction> all;
  for (const Body& body : tree.bodies())
    for (const Direction& direction : jointDirections(tree.graph(), body.joint))
      all.push_back(direction);
  for (const Body& body : tree.bodies())  // a leader's rate moves its followers too
    if (body.joint.follows)
      all[body.joint.rate].push_back({{Input::kPosition, body.joint.slot}, body.joint.ratio.node});
  return all;
}

int parallelInboard(const BodyTree& tree, int body) {
  const std::vector<Body>& bodies = tree.bodies();
  Graph* graph = tree.graph();
  const auto sense = [&](const Joint& joint) { return constant(graph, joint.reversed ? -1 : 1); };
  if (bodies[body].joint.kind != Joint::Kind::kTurn) return -1;
  Vector3 direction = zeroVector(graph);
  direction[bodies[body].joint.axis] = sense(bodies[body].joint);
  for (int k = body; bodies[k].parent >= 0;) {
    direction = Placed(graph, bodies[k].before).turnedBack(direction);
    k = bodies[k].parent;
    const Joint& joint = bodies[k].joint;
    if (joint.kind == Joint::Kind::kSlide) continue;
    if (joint.kind != Joint::Kind::kTurn) return -1;
    return direction[joint.axis].node == sense(joint).node ? k : -1;
  }
  return -1;
}

}  // namespace dynwitness::symbolic
