// SPDX-License-Identifier: GPL-3.0-or-later
#include "symbolic/graph.hpp"

#include <algorithm>
#include <stdexcept>

#include "scene/rational_signs.hpp"

namespace dynwitness::symbolic {
namespace {

using scene::isNegative;
using scene::isUnit;

/// The node that scaled() finds, without its factor.
Node withoutFactor(const Graph& graph, Node n) {
  if (graph.op(n) == Op::kNegate) n = graph.left(n);
  return graph.op(n) == Op::kMultiply && graph.isConstant(graph.left(n)) ? graph.right(n) : n;
}

/// What is to be summed at each node, in the order in which it came: one list for all.
class Terms {
 public:
  explicit Terms(int nodes) : ends_(static_cast<std::size_t>(nodes)) {}
  void add(Node to, Node term) {
    Ends& ends = ends_[static_cast<std::size_t>(to.index)];
    const auto place = static_cast<int>(all_.size());
    all_.push_back({term, -1});
    (ends.last < 0 ? ends.first : all_[static_cast<std::size_t>(ends.last)].next) = place;
    ends.last = place;
  }
  /// @return whether there are any
  bool take(Node of, std::vector<Node>* terms) const {
    terms->clear();
    for (int i = ends_[static_cast<std::size_t>(of.index)].first; i >= 0;
         i = all_[static_cast<std::size_t>(i)].next)
      terms->push_back(all_[static_cast<std::size_t>(i)].term);
    return !terms->empty();
  }

 private:
  struct Ends {
    int first = -1, last = -1;
  };
  struct Term {
    Node term;
    int next;
  };
  std::vector<Ends> ends_;
  std::vector<Term> all_;
};

}  // namespace

std::size_t Graph::hashOf(const Entry& entry) {
  std::uint64_t h = 1469598103934665603u;
  for (int part : {static_cast<int>(entry.op) + 16 * entry.joint, entry.a, entry.b})
    h = (h ^ static_cast<std::uint32_t>(part)) * 1099511628211u;
  return static_cast<std::size_t>(h ^ (h >> 29));
}

Graph::Graph() : buckets_(256, 0) {
  constant(0);  // node 0: what a default Node means
  constant(1);  // node 1
}

Node Graph::intern(Op op, int joint, int a, int b, bool depends_on_state) {
  const Entry entry{op, depends_on_state, joint, a, b};
  const std::size_t mask = buckets_.size() - 1;
  std::size_t at = hashOf(entry) & mask;
  for (; buckets_[at] != 0; at = (at + 1) & mask) {
    const Entry& known = entries_[buckets_[at]];
    if (known.op == op && known.joint == joint && known.a == a && known.b == b)
      return {buckets_[at]};
  }
  if (op == Op::kConstant && a == 0 && !entries_.empty()) return {};
  entries_.push_back(entry);
  buckets_[at] = size() - 1;
  if (2 * entries_.size() > buckets_.size()) growBuckets();
  return {size() - 1};
}

void Graph::growBuckets() {
  buckets_.assign(4 * buckets_.size(), 0);
  const std::size_t mask = buckets_.size() - 1;
  for (int i = 1; i < size(); ++i) {
    std::size_t at = hashOf(entries_[i]) & mask;
    while (buckets_[at] != 0) at = (at + 1) & mask;
    buckets_[at] = i;
  }
}

Node Graph::operation(Op op, Node a, Node b, int joint) {
  const bool unary = op == Op::kNegate || op == Op::kInverse;
  const bool moves = op == Op::kTurn || dependsOnState(a) || (!unary && dependsOnState(b));
  return intern(op, joint, a.index, unary ? 0 : b.index, moves);
}

Node Graph::constant(const Rational& value) {
  // looked for by hand, since the map would divide to compare
  const std::size_t bucket = constant_index_.bucket(value);
  for (auto it = constant_index_.begin(bucket); it != constant_index_.end(bucket); ++it)
    if (scene::areEqual(it->first, value)) return intern(Op::kConstant, 0, it->second, 0, false);
  const auto added = static_cast<int>(constants_.size());
  constants_.push_back(value);
  constant_index_.emplace(value, added);
  return intern(Op::kConstant, 0, added, 0, false);
}

Node Graph::atom(const Atom& atom) {
  const auto [it, is_new] = atom_index_.emplace(atom.name, static_cast<int>(atoms_.size()));
  if (is_new) atoms_.push_back(atom);
  return intern(Op::kAtom, 0, it->second, 0, false);
}

Node Graph::input(Input input, int joint) {
  return intern(Op::kInput, joint, static_cast<int>(input), 0, true);
}

int Graph::operandCount(Node n) const {
  switch (op(n)) {
    case Op::kConstant:
    case Op::kAtom:
    case Op::kInput:
      return 0;
    case Op::kNegate:
    case Op::kInverse:
      return 1;
    default:
      return 2;
  }
}

Node Graph::withoutSign(Node n, bool* negative) const {
  if (op(n) == Op::kNegate) {
    *negative = !*negative;
    return left(n);
  }
  return n;
}

Graph::Scaled Graph::scaled(Node n) const {
  bool negative = false;
  n = withoutSign(n, &negative);
  Scaled result{1, n};
  if (op(n) == Op::kMultiply && isConstant(left(n))) result = {value(left(n)), right(n)};
  if (negative) result.factor = -result.factor;
  return result;
}

Node Graph::scale(const Rational& factor, Node n) {
  if (scene::isZero(factor) || isZero(n)) return {};
  if (isUnit(factor)) return isNegative(factor) ? negate(n) : n;
  if (isConstant(n)) return constant(factor * value(n));
  bool negative = false;
  Node x = withoutSign(n, &negative);
  // most nodes have no factor of their own: no rational is made for them
  Rational with_own;
  const Rational* f = &factor;
  if (op(x) == Op::kMultiply && isConstant(left(x))) {
    with_own = factor * value(left(x));
    x = right(x);
    f = &with_own;
  }
  if (isNegative(*f)) negative = !negative;
  if (isUnit(*f)) return negative ? operation(Op::kNegate, x, {}) : x;
  if (op(x) == Op::kMultiply && dependsOnState(x) && !dependsOnState(left(x))) {
    const bool flips = isNegative(*f) != negative;
    const Node scaled_left = scale(*f, left(x));
    return multiply(flips ? negate(scaled_left) : scaled_left, right(x));
  }
  // the sign stays outside, where the next sum or product takes it up
  const Node size = isNegative(*f) ? constant(-*f) : constant(*f);
  const Node product = operation(Op::kMultiply, size, x);
  return negative ? operation(Op::kNegate, product, {}) : product;
}

Node Graph::negate(Node a) {
  if (isZero(a)) return a;  // without a rational for it, as above
  if (isConstant(a)) return constant(-value(a));
  if (op(a) == Op::kNegate) return left(a);
  return operation(Op::kNegate, a, {});
}

bool Graph::isTrig(Node n) const {
  return op(n) == Op::kInput && (inputKind(n) == Input::kCos || inputKind(n) == Input::kSin);
}

bool Graph::asTrigTimes(Node n, int* joint_out, bool* is_sine, Node* other) const {
  if (op(n) != Op::kMultiply) return false;
  Node trig = right(n);
  *other = left(n);
  if (!isTrig(trig)) std::swap(trig, *other);
  if (!isTrig(trig)) return false;
  *joint_out = joint(trig);
  *is_sine = inputKind(trig) == Input::kSin;
  return true;
}

Node Graph::add(Node a, Node b) {
  if (isZero(a)) return b;
  if (isZero(b)) return a;
  if (isConstant(a) && isConstant(b)) return constant(value(a) + value(b));

  // r x + s x = (r + s) x
  if (const Node x = withoutFactor(*this, a); x == withoutFactor(*this, b))
    return scale(scaled(a).factor + scaled(b).factor, x);

  bool negative_a = false, negative_b = false;
  a = withoutSign(a, &negative_a);
  b = withoutSign(b, &negative_b);

  // c_k x + s_k y, with signs
  int joint_a = 0, joint_b = 0;
  bool sine_a = false, sine_b = false;
  Node x, y;
  if (asTrigTimes(a, &joint_a, &sine_a, &x) && asTrigTimes(b, &joint_b, &sine_b, &y) &&
      joint_a == joint_b && sine_a != sine_b) {
    if (negative_a) x = negate(x);
    if (negative_b) y = negate(y);
    return sine_a ? turn(joint_a, y, x) : turn(joint_a, x, y);
  }

  // x - (x - y) = y and its relatives: exact cancellation must leave nothing behind
  if (negative_a != negative_b) {
    const Node plus = negative_a ? b : a, minus = negative_a ? a : b;
    if (op(minus) == Op::kSubtract && left(minus) == plus) return right(minus);
    if (op(plus) == Op::kSubtract && left(plus) == minus) return negate(right(plus));
    if (op(plus) == Op::kAdd && left(plus) == minus) return right(plus);
    if (op(plus) == Op::kAdd && right(plus) == minus) return left(plus);
    if (op(minus) == Op::kAdd && left(minus) == plus) return negate(right(minus));
    if (op(minus) == Op::kAdd && right(minus) == plus) return negate(left(minus));
  } else {
    if (op(a) == Op::kSubtract && right(a) == b) return negative_a ? negate(left(a)) : left(a);
    if (op(b) == Op::kSubtract && right(b) == a) return negative_a ? negate(left(b)) : left(b);
  }

  // one stored form for x + y = y + x and for x - y = -(y - x)
  if (b < a) {
    std::swap(a, b);
    std::swap(negative_a, negative_b);
  }
  const Node result = operation(negative_a == negative_b ? Op::kAdd : Op::kSubtract, a, b);
  return negative_a ? operation(Op::kNegate, result, {}) : result;
}

Node Graph::multiply(Node a, Node b) {
  if (isConstant(a)) return scale(value(a), b);
  if (isConstant(b)) return scale(value(b), a);
  bool negative = false;
  a = withoutSign(a, &negative);
  b = withoutSign(b, &negative);
  if (dependsOnState(a) && !dependsOnState(b)) std::swap(a, b);
  // numbers of the scene are multiplied among themselves, so that they leave the loop: p (r x)
  Node result;
  if (!dependsOnState(a) && op(b) == Op::kMultiply && dependsOnState(b) &&
      !dependsOnState(left(b))) {
    result = multiply(multiply(a, left(b)), right(b));
  } else {
    if (dependsOnState(a) == dependsOnState(b) && b < a) std::swap(a, b);
    const auto plain = [&] {
      const bool are_inverse =
          (op(a) == Op::kInverse && left(a) == b) || (op(b) == Op::kInverse && left(b) == a);
      return are_inverse ? Node{1} : operation(Op::kMultiply, a, b);
    };
    const Node x = withoutFactor(*this, a), y = withoutFactor(*this, b);
    if (dependsOnState(a) || dependsOnState(b) || (x == a && y == b)) {
      result = plain();
    } else {  // 2 x (y / 2) stays as it is
      const Rational factor = scaled(a).factor * scaled(b).factor;
      result = isUnit(factor) && !isNegative(factor) ? plain() : scale(factor, multiply(x, y));
    }
  }
  return negative ? negate(result) : result;
}

Node Graph::inverse(Node a) {
  if (isZero(a)) throw std::invalid_argument("Graph::inverse: expected a number that is not 0");
  if (isConstant(a)) return constant(1 / value(a));
  if (op(a) == Op::kInverse) return left(a);
  if (op(a) == Op::kNegate) return negate(inverse(left(a)));
  return operation(Op::kInverse, a, {});
}

Node Graph::turn(int joint, Node a, Node b) {
  if (isZero(a)) return multiply(input(Input::kSin, joint), b);
  if (isZero(b)) return multiply(input(Input::kCos, joint), a);
  if (op(a) == Op::kNegate || (isConstant(a) && isNegative(value(a))))
    return negate(operation(Op::kTurn, negate(a), negate(b), joint));
  return operation(Op::kTurn, a, b, joint);
}

Node Graph::sum(const std::vector<Node>& terms) {
  struct Gathered {
    std::vector<Node> cos, sin;
  };
  std::map<int, Gathered> turns;
  std::vector<Node> rest;
  if (terms.size() == 1 && op(terms[0]) != Op::kMultiply && op(terms[0]) != Op::kNegate)
    return terms[0];
  for (Node term : terms) {
    bool negative = false, is_sine = false;
    int joint = 0;
    Node other;
    if (asTrigTimes(withoutSign(term, &negative), &joint, &is_sine, &other)) {
      if (negative) other = negate(other);
      (is_sine ? turns[joint].sin : turns[joint].cos).push_back(other);
    } else {
      rest.push_back(term);
    }
  }
  const auto plainSum = [this](const std::vector<Node>& nodes) {
    Node total;
    for (Node n : nodes) total = add(total, n);
    return total;
  };
  for (const auto& [joint, gathered] : turns)
    rest.push_back(turn(joint, plainSum(gathered.cos), plainSum(gathered.sin)));
  return plainSum(rest);
}

void Graph::setName(Node n, const std::string& name) {
  if (operandCount(n) == 0 || op(n) == Op::kNegate) return;
  names_.emplace(n.index, name);
}

const std::string& Graph::name(Node n) const {
  static const std::string kNone;
  const auto it = names_.find(n.index);
  return it == names_.end() ? kNone : it->second;
}

std::vector<int> Graph::below(const std::vector<Node>& nodes) const {
  int last = 0;
  for (Node n : nodes) last = std::max(last, n.index);
  std::vector<char> reached(last + 1, 0);
  std::vector<int> result;
  const auto reach = [&](int i) {
    if (reached[i] != 0) return;
    reached[i] = 1;
    result.push_back(i);
  };
  for (Node n : nodes) reach(n.index);
  for (std::size_t k = 0; k < result.size(); ++k) {  // it grows
    const int i = result[k], operands = operandCount({i});
    if (operands > 0) reach(entries_[i].a);
    if (operands > 1) reach(entries_[i].b);
  }
  // many are found in order faster than they are sorted
  if (16 * result.size() < reached.size()) {
    std::sort(result.begin(), result.end());
    return result;
  }
  result.clear();
  for (int i = 0; i <= last; ++i)
    if (reached[i] != 0) result.push_back(i);
  return result;
}

Node Graph::trigDerivative(Node trig) {
  const bool is_sine = inputKind(trig) == Input::kSin;
  return is_sine ? input(Input::kCos, joint(trig)) : negate(input(Input::kSin, joint(trig)));
}

std::vector<Node> Graph::directionalDerivative(const std::vector<Node>& nodes,
                                               const Direction& direction) {
  std::map<std::pair<Input, int>, Node> speed;
  for (const auto& [variable, node] : direction) speed[{variable.input, variable.joint}] = node;
  const auto speedOf = [&speed](Input input, int joint) {
    const auto it = speed.find({input, joint});
    return it == speed.end() ? Node{} : it->second;
  };

  const std::vector<int> order = below(nodes);
  std::vector<Node> d(order.empty() ? 0 : order.back() + 1);
  // d(c_k a + s_k b) = (c_k da + s_k db) + dq_k (c_k b - s_k a): the last bracket is the other
  // coordinate of the turned vector, which exists already
  const auto turnDerivative = [&](int k, Node a, Node b) {
    const Node dq = speedOf(Input::kPosition, k);
    const Node carried = turn(k, d[a.index], d[b.index]);
    if (isZero(dq)) return carried;
    return add(carried, multiply(dq, turn(k, b, negate(a))));
  };
  // along one rate of many most nodes rest: whatever has no angle of its own and only what rests
  const auto rests = [&](Node n) {
    const int operands = operandCount(n);
    return operands > 0 && isZero(d[left(n).index]) &&
           (operands == 1 || isZero(d[right(n).index])) &&
           (op(n) != Op::kTurn || isZero(speedOf(Input::kPosition, joint(n))));
  };
  for (int i : order) {
    const Node n{i};
    if (rests(n)) continue;
    const Node a = left(n), b = right(n);
    switch (op(n)) {
      case Op::kConstant:
      case Op::kAtom:
        break;            // numbers of the scene do not move
      case Op::kInverse:  // d(1/a) = -da / a^2
        d[i] = negate(multiply(multiply(n, n), d[a.index]));
        break;
      case Op::kInput:
        if (isTrig(n)) {
          const Node dq = speedOf(Input::kPosition, joint(n));
          if (!isZero(dq)) d[i] = multiply(dq, trigDerivative(n));
        } else {
          d[i] = speedOf(inputKind(n), joint(n));
        }
        break;
      case Op::kAdd:
        d[i] = add(d[a.index], d[b.index]);
        break;
      case Op::kSubtract:
        d[i] = subtract(d[a.index], d[b.index]);
        break;
      case Op::kNegate:
        d[i] = negate(d[a.index]);
        break;
      case Op::kTurn:
        d[i] = turnDerivative(joint(n), a, b);
        break;
      case Op::kMultiply: {
        if (isTrig(a) || isTrig(b)) {
          // as a turn with one component, for each factor that is a cosine or sine
          Node total;
          for (const auto& [trig, other] : {std::pair(a, b), std::pair(b, a)}) {
            if (isTrig(trig)) {
              const Node dq = speedOf(Input::kPosition, joint(trig));
              if (!isZero(dq))
                total = add(total, multiply(dq, multiply(trigDerivative(trig), other)));
            } else {
              total = add(total, multiply(other, d[trig.index]));
            }
          }
          d[i] = total;
        } else if (a == b) {
          d[i] = multiply(scale(2, a), d[a.index]);
        } else {
          d[i] = add(multiply(d[a.index], b), multiply(a, d[b.index]));
        }
        break;
      }
    }
  }
  std::vector<Node> result;
  for (Node n : nodes) result.push_back(d[n.index]);
  return result;
}

std::vector<Node> Graph::gradient(Node n, const std::vector<Variable>& variables,
                                  const std::vector<Node>& atoms) {
  std::map<Node, std::size_t> wanted_atoms;
  for (std::size_t i = 0; i < atoms.size(); ++i) wanted_atoms[atoms[i]] = variables.size() + i;
  std::map<std::pair<Input, int>, std::size_t> wanted;
  for (std::size_t i = 0; i < variables.size(); ++i)
    wanted[{variables[i].input, variables[i].joint}] = i;
  const auto find = [&wanted](Input input, int joint) {
    const auto it = wanted.find({input, joint});
    return it == wanted.end() ? -1 : static_cast<int>(it->second);
  };
  const auto variableOf = [&](Node leaf) {
    return find(isTrig(leaf) ? Input::kPosition : inputKind(leaf), joint(leaf));
  };

  // which nodes depend on a wanted variable at all
  const std::vector<int> order = below({n});
  std::vector<char> active(n.index + 1, 0);
  for (int i : order) {
    const Node m{i};
    const int operands = operandCount(m);
    if (op(m) == Op::kAtom) active[i] = wanted_atoms.count(m) > 0;
    if (op(m) == Op::kInput) active[i] = variableOf(m) >= 0;
    if (op(m) == Op::kTurn) active[i] = find(Input::kPosition, joint(m)) >= 0;
    if (operands > 0 && active[left(m).index]) active[i] = 1;
    if (operands > 1 && active[right(m).index]) active[i] = 1;
  }

  Terms parts(n.index + 1);  // of each node's adjoint
  std::vector<Node> terms;
  std::vector<std::vector<Node>> results(variables.size() + atoms.size());
  const auto send = [&](Node to, Node amount) {
    if (active[to.index] && !isZero(amount)) parts.add(to, amount);
  };
  parts.add(n, constant(1));
  for (auto it = order.rbegin(); it != order.rend(); ++it) {
    const Node m{*it};
    if (!active[*it] || !parts.take(m, &terms)) continue;
    const Node lambda = sum(terms);
    if (isZero(lambda)) continue;
    const Node a = left(m), b = right(m);
    switch (op(m)) {
      case Op::kConstant:
        break;
      case Op::kAtom:
        results[wanted_atoms.at(m)].push_back(lambda);
        break;
      case Op::kInverse:
        send(a, negate(multiply(multiply(m, m), lambda)));
        break;
      case Op::kInput: {
        const Node slope = isTrig(m) ? trigDerivative(m) : Node{1};
        results[variableOf(m)].push_back(multiply(lambda, slope));
        break;
      }
      case Op::kAdd:
        send(a, lambda);
        send(b, lambda);
        break;
      case Op::kSubtract:
        send(a, lambda);
        send(b, negate(lambda));
        break;
      case Op::kNegate:
        send(a, negate(lambda));
        break;
      case Op::kTurn: {
        const int k = joint(m);
        if (active[a.index]) send(a, multiply(input(Input::kCos, k), lambda));
        if (active[b.index]) send(b, multiply(input(Input::kSin, k), lambda));
        const int variable = find(Input::kPosition, k);
        if (variable >= 0) results[variable].push_back(multiply(lambda, turn(k, b, negate(a))));
        break;
      }
      case Op::kMultiply:
        if (isTrig(a) || isTrig(b)) {
          for (const auto& [factor, other] : {std::pair(a, b), std::pair(b, a)}) {
            if (!active[factor.index]) continue;
            if (isTrig(factor))
              results[variableOf(factor)].push_back(
                  multiply(lambda, multiply(trigDerivative(factor), other)));
            else
              send(factor, multiply(other, lambda));
          }
        } else if (a == b) {
          send(a, multiply(scale(2, lambda), a));
        } else {
          if (active[a.index]) send(a, multiply(b, lambda));
          if (active[b.index]) send(b, multiply(a, lambda));
        }
        break;
    }
  }
  std::vector<Node> gradient;
  for (const std::vector<Node>& terms : results) gradient.push_back(sum(terms));
  return gradient;
}

}  // namespace dynwitness::symbolic
