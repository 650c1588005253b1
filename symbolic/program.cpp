// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/program.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>

namespace dynwitness::symbolic {

namespace {

/// The slot of each operation; -1 where there is none yet.
class Emitted {
 public:
  /// Room for so many operations without looking for places anew; before the first.
  void expect(std::size_t operations) {
    std::size_t size = known_.size();
    while (size < 2 * operations) size *= 2;
    known_.resize(size, kEmpty);
  }
  int& operator[](Program::Instruction i) {
    if (2 * count_ >= known_.size()) grow();
    i.result = -1;
    Program::Instruction& place = placeOf(i);
    if (place.a < 0) {
      place = i;
      ++count_;
    }
    return place.result;
  }

 private:
  /// Where it is, or the empty place (a = -1) where it would be.
  Program::Instruction& placeOf(const Program::Instruction& i) {
    std::uint64_t h = 1469598103934665603u;
    for (const int part : {static_cast<int>(i.code), i.a, i.b})
      h = (h ^ static_cast<std::uint32_t>(part)) * 1099511628211u;
    std::size_t at = static_cast<std::size_t>(h ^ (h >> 29)) & (known_.size() - 1);
    const auto isOther = [&i](const Program::Instruction& other) {
      return other.a >= 0 && (other.code != i.code || other.a != i.a || other.b != i.b);
    };
    while (isOther(known_[at])) at = (at + 1) & (known_.size() - 1);
    return known_[at];
  }
  void grow() {
    std::vector<Program::Instruction> old(2 * known_.size(), kEmpty);
    old.swap(known_);
    for (const Program::Instruction& i : old)
      if (i.a >= 0) placeOf(i) = i;
  }

  static constexpr Program::Instruction kEmpty{Program::Code::kAdd, -1, -1, -1};
  std::vector<Program::Instruction> known_ = std::vector<Program::Instruction>(256, kEmpty);
  std::size_t count_ = 0;
};

/// Lowers nodes to instructions: a turn becomes two products and a sum, a sign moves into the sum
/// that uses it.
class Compiler {
 public:
  Compiler(const Graph& graph, const std::vector<Node>& outputs)
      : graph_(graph), next_name_(graph.names().begin()) {
    for (Node n : outputs) need(n);
    collect();
    emitted_.expect(order_.size());
    for (const int i : order_)
      if (graph_.operandCount({i}) > 0 && graph_.op({i}) != Op::kNegate) lower({i});
    for (Node n : outputs) program_.outputs.push_back(outputSlot(n));
  }

  Program take() {
    program_.slots = static_cast<int>(program_.slot_names.size());
    return std::move(program_);
  }

 private:
  /// A value with its sign outside.
  struct Signed {
    int slot;
    bool negative;
  };

  void need(Node n) {
    if (static_cast<int>(needed_.size()) <= n.index) needed_.resize(n.index + 1, 0);
    needed_[n.index] = 1;
  }

  // marks what is needed, then gives leaves their slots
  void collect() {
    for (int i = static_cast<int>(needed_.size()) - 1; i >= 0; --i) {
      if (!needed_[i]) continue;
      order_.push_back(i);
      const Node n{i};
      const int operands = graph_.operandCount(n);
      if (operands > 0) need(graph_.left(n));
      if (operands > 1) need(graph_.right(n));
      if (graph_.op(n) == Op::kTurn) uses_trig_.insert(graph_.joint(n));
    }
    std::reverse(order_.begin(), order_.end());
    slot_of_.assign(needed_.size(), -1);
    program_.constants.push_back(1);  // slot 0, which inverses read
    newSlot();
    for (const int i : order_) {
      if (!graph_.isConstant({i})) continue;
      if (graph_.isOne({i})) {
        slot_of_[i] = 0;
        continue;
      }
      program_.constants.push_back(graph_.value({i}));
      slot_of_[i] = newSlot();
    }
    for (const int i : order_) {
      if (graph_.op({i}) != Op::kAtom) continue;
      program_.atoms.push_back(graph_.atom(Node{i}));
      slot_of_[i] = newSlot(graph_.atom(Node{i}).name);
    }
    for (const int i : order_)
      if (graph_.op({i}) == Op::kInput) load(graph_.inputKind({i}), graph_.joint({i}));
    for (int joint : uses_trig_) {
      load(Input::kCos, joint);
      load(Input::kSin, joint);
    }
    for (const int i : order_)
      if (graph_.op({i}) == Op::kInput)
        slot_of_[i] = load(graph_.inputKind({i}), graph_.joint({i}));
  }

  int newSlot(const std::string& name) {
    program_.slot_names.push_back(name);
    return static_cast<int>(program_.slot_names.size()) - 1;
  }
  int newSlot() {
    program_.slot_names.emplace_back();
    return static_cast<int>(program_.slot_names.size()) - 1;
  }
  /// Of nodes that are asked for in their order; null for those without a name.
  const std::string* nameOf(int node) {
    const std::map<int, std::string>& names = graph_.names();
    while (next_name_ != names.end() && next_name_->first < node) ++next_name_;
    return next_name_ != names.end() && next_name_->first == node ? &next_name_->second : nullptr;
  }

  int load(Input input, int joint) {
    const auto [it, is_new] = load_of_.emplace(std::make_pair(input, joint), 0);
    if (is_new) {
      it->second = newSlot();
      program_.loads.push_back({input, joint, it->second});
    }
    return it->second;
  }

  Signed value(Node n) const {
    if (graph_.op(n) == Op::kNegate) return {slot_of_[graph_.left(n).index], true};
    return {slot_of_[n.index], false};
  }

  /// @param name  may be null
  int emit(Program::Code code, int a, int b, bool in_body, const std::string* name = nullptr) {
    const bool commutes = code == Program::Code::kAdd || code == Program::Code::kMultiply;
    if (commutes && b < a) std::swap(a, b);
    int& slot = emitted_[{code, 0, a, b}];
    if (slot < 0) {
      slot = name ? newSlot(*name) : newSlot();
      (in_body ? program_.body : program_.prologue).push_back({code, slot, a, b});
    }
    return slot;
  }

  void lower(Node n) {
    const bool in_body = graph_.dependsOnState(n);
    const std::string* name = nameOf(n.index);
    const Signed a = value(graph_.left(n));
    const Signed b = graph_.operandCount(n) > 1 ? value(graph_.right(n)) : Signed{0, false};
    int& slot = slot_of_[n.index];
    // the graph keeps signs outside of sums and products, and of the first operand of a turn
    switch (graph_.op(n)) {
      case Op::kAdd:
        slot = emit(Program::Code::kAdd, a.slot, b.slot, in_body, name);
        break;
      case Op::kSubtract:
        slot = emit(Program::Code::kSubtract, a.slot, b.slot, in_body, name);
        break;
      case Op::kMultiply:
        slot = emit(Program::Code::kMultiply, a.slot, b.slot, in_body, name);
        break;
      case Op::kTurn: {
        const int x =
            emit(Program::Code::kMultiply, load(Input::kCos, graph_.joint(n)), a.slot, true);
        const int y =
            emit(Program::Code::kMultiply, load(Input::kSin, graph_.joint(n)), b.slot, true);
        slot = emit(b.negative ? Program::Code::kSubtract : Program::Code::kAdd, x, y, true, name);
        break;
      }
      case Op::kInverse:
        slot = emit(Program::Code::kInverse, a.slot, 0, in_body, name);
        break;
      default:
        break;
    }
  }

  int outputSlot(Node n) {
    const Signed v = value(n);
    if (!v.negative) return v.slot;
    return emit(Program::Code::kNegate, v.slot, 0, graph_.dependsOnState(n));
  }

  const Graph& graph_;
  Program program_;
  std::vector<char> needed_;
  std::vector<int> order_;  ///< of the nodes that are needed
  std::vector<int> slot_of_;
  std::map<std::pair<Input, int>, int> load_of_;
  std::set<int> uses_trig_;
  std::map<int, std::string>::const_iterator next_name_;
  Emitted emitted_;
};

}  // namespace

Program::Operations Program::bodyOperations() const {
  Operations operations;
  for (const Instruction& i : body) {
    switch (i.code) {
      case Program::Code::kAdd:
      case Program::Code::kSubtract:
        ++operations.additions;
        break;
      case Program::Code::kMultiply:
        ++operations.multiplications;
        break;
      case Program::Code::kInverse:
        ++operations.divisions;
        break;
      case Program::Code::kNegate:
        break;
    }
  }
  return operations;
}

Program compile(const Graph& graph, const std::vector<Node>& outputs) {
  return Compiler(graph, outputs).take();
}

}  // namespace dynwitness::symbolic
