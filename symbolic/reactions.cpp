// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/reactions.hpp"

#include <stdexcept>

namespace dynwitness::symbolic {

Freed freed(const scene::Mechanism& mechanism) {
  Freed out;
  out.mechanism = mechanism;
  out.mechanism.links.clear();
  int rates = 0, slots = 0;
  const auto append = [&](scene::Link link, bool is_cut) {
    const auto kind = link.joint.kind;
    for (int k = 0; k < link.joint.ownRates(); ++k) out.rate.push_back(is_cut ? -1 : rates++);
    for (std::size_t k = 0; k < scene::positionSlots(kind).size(); ++k)
      out.slot.push_back(is_cut ? -1 : slots++);
    out.mechanism.links.push_back(std::move(link));
  };
  for (const scene::Link& link : mechanism.links) {
    scene::Link let_go = link;
    if (link.parent >= 0) {
      // the moved joint frame, without mass, on the joint as it is; and the link on that
      scene::Link frame;
      frame.name = link.name + ".joint";
      frame.parent = out.link[link.parent];
      frame.joint = link.joint;
      let_go.joint = scene::Joint();
      let_go.joint.name = link.joint.name + ".cut";
      let_go.joint.kind = scene::JointKind::kFloating;
      if (link.joint.placement.convention == scene::Placement::Convention::kDh) {
        // what of the row comes after the joint's motion stays with the link
        let_go.joint.placement = link.joint.placement;
        frame.joint.placement = scene::Placement();
      }
      let_go.parent = static_cast<int>(out.mechanism.links.size());
      append(frame, false);
    }
    append(let_go, link.parent >= 0);
    out.link.push_back(static_cast<int>(out.mechanism.links.size()) - 1);
  }
  for (scene::Wrench& wrench : out.mechanism.wrenches) wrench.link = out.link[wrench.link];
  for (scene::Closure& closure : out.mechanism.closures)
    for (scene::Attachment* end : {&closure.a, &closure.b}) end->link = out.link[end->link];
  for (scene::Spring& spring : out.mechanism.springs)
    for (scene::Attachment* end : {&spring.a, &spring.b}) end->link = out.link[end->link];
  for (scene::AccelerationConstraint& held : out.mechanism.acceleration_constraints)
    held.link = out.link[held.link];
  return out;
}

namespace {

/// Nodes of the freed mechanism where its cuts are closed and rest, in a graph of their own.
class Closed {
 public:
  Closed(const Graph& from, const Freed& freed, Graph* to)
      : from_(from), freed_(freed), to_(to), image_(from.size()), known_(from.size(), 0) {}

  Node operator()(Node n) {
    // operands come before what uses them; the recursion of a deep graph would be too deep
    std::vector<Node> waiting = {n};
    while (!waiting.empty()) {
      const Node m = waiting.back();
      const std::size_t before = waiting.size();
      if (!known_[m.index]) {
        const int operands = from_.operandCount(m);
        if (operands > 0 && !known_[from_.left(m).index]) waiting.push_back(from_.left(m));
        if (operands > 1 && !known_[from_.right(m).index]) waiting.push_back(from_.right(m));
      }
      if (waiting.size() > before) continue;
      if (!known_[m.index]) image_[m.index] = made(m);
      known_[m.index] = 1;
      waiting.pop_back();
    }
    return image_[n.index];
  }

 private:
  Node at(Node n) const { return image_[n.index]; }

  Node made(Node n) {
    switch (from_.op(n)) {
      case Op::kConstant:
        return to_->constant(from_.value(n));
      case Op::kAtom:
        return to_->atom(from_.atom(n));
      case Op::kInput:
        return input(from_.inputKind(n), from_.joint(n));
      case Op::kAdd:
        return to_->add(at(from_.left(n)), at(from_.right(n)));
      case Op::kSubtract:
        return to_->subtract(at(from_.left(n)), at(from_.right(n)));
      case Op::kMultiply:
        return to_->multiply(at(from_.left(n)), at(from_.right(n)));
      case Op::kNegate:
        return to_->negate(at(from_.left(n)));
      case Op::kInverse:
        return to_->inverse(at(from_.left(n)));
      case Op::kTurn: {
        const int slot = freed_.slot[from_.joint(n)];  // a cut has no angle
        return to_->turn(slot, at(from_.left(n)), at(from_.right(n)));
      }
    }
    throw std::logic_error("reactions: unknown operation");
  }

  Node input(Input kind, int index) {
    switch (kind) {
      case Input::kPosition:
      case Input::kCos:
      case Input::kSin: {
        const int slot = freed_.slot[index];
        return slot < 0 ? Node{} : to_->input(kind, slot);
      }
      case Input::kRotation: {
        const int slot = freed_.slot[index / 9], entry = index % 9;
        if (slot >= 0) return to_->input(kind, 9 * slot + entry);
        return to_->constant(entry % 4 == 0 ? 1 : 0);
      }
      case Input::kVelocity:
      case Input::kAcceleration:
      case Input::kForce:
      case Input::kDirection: {
        const int rate = freed_.rate[index];
        return rate < 0 ? Node{} : to_->input(kind, rate);
      }
    }
    throw std::logic_error("reactions: unknown input");
  }

  const Graph& from_;
  const Freed& freed_;
  Graph* to_;
  std::vector<Node> image_;
  std::vector<char> known_;
};

}  // namespace

Reactions reactionsAlong(const scene::Mechanism& mechanism, const Options& options,
                         const std::vector<scene::Attachment>& frames) {
  const Freed cut = freed(mechanism);
  std::vector<scene::Attachment> let_go = frames;
  for (scene::Attachment& frame : let_go) frame.link = cut.link[frame.link];
  Equations e = deriveForInverseDynamics(cut.mechanism, options);
  const std::vector<Node> all = inverseDynamics(e);
  const ClosureEquations closures = closureEquations(cut.mechanism, options, e, false),
                         places = frameEquations(cut.mechanism, options, let_go, e, false);
  Reactions out;
  Closed closed(e.graph, cut, &out.graph);
  const auto ofCuts = [&](const std::vector<Node>& row) {
    std::vector<Node> kept;
    for (std::size_t i = 0; i < row.size(); ++i)
      if (cut.rate[i] < 0) kept.push_back(closed(row[i]));
    return kept;
  };
  out.lambda = ofCuts(all);
  for (const auto& row : closures.J) out.by_closure.push_back(ofCuts(row));
  for (const auto& row : places.J) out.by_frame.push_back(ofCuts(row));
  return out;
}

Reactions reactions(const scene::Mechanism& mechanism, const Options& options) {
  scene::Mechanism tree = mechanism;
  tree.closures.clear();
  return reactionsAlong(tree, options, {});
}

}  // namespace dynwitness::symbolic
