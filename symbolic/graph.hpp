// SPDX-License-Identifier: GPL-3.0-or-later
// Expressions as one shared, append-only list of operations, and their derivatives.
//
// Every operation is stored once: asking for it again gives the node that exists already, so the
// list is a straight-line program without repeated sub-expressions. Operands come before the
// operations that use them, and nodes are numbered in the order in which they were first asked for,
// so the same scene gives the same numbers in every run.
//
// Joint angles enter as two symbols each, c_k and s_k, with  d c_k = -s_k dq_k,  d s_k = c_k dq_k;
// quaternions as the nine entries of their rotation R. In a graph these entries are variables like
// any other; that they move together, dR = R [w]x dt, is the business of quasi_velocities.hpp.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "scene/mechanism.hpp"

namespace dynwitness::symbolic {

using scene::Rational;

/// A place in a Graph. The default is the number 0.
struct Node {
  int index = 0;
  friend bool operator==(Node a, Node b) { return a.index == b.index; }
  friend bool operator!=(Node a, Node b) { return a.index != b.index; }
  friend bool operator<(Node a, Node b) { return a.index < b.index; }
};

enum class Op : std::uint8_t {
  kConstant,  ///< an exact rational number
  kAtom,      ///< a number of the scene that stays a symbol
  kInput,     ///< a component of the state
  kAdd,       ///< a + b
  kSubtract,  ///< a - b
  kMultiply,  ///< a b
  kNegate,    ///< -a
  kTurn,      ///< c_k a + s_k b: what a joint angle does to coordinates
  kInverse,   ///< 1 / a
};

/// A number of the scene that has no exact rational value, or that is kept by name.
struct Atom {
  enum class Kind { kNumber, kCos, kSin, kCosAlpha, kSinAlpha, kCosBeta, kSinBeta };
  Kind kind;
  scene::Number number;  ///< kNumber: a parameter or pi; kCos, kSin: the angle [rad]
  scene::Vector axis;    ///< kCosAlpha ... kSinBeta: the axis whose AxisTurn is meant
  std::string name;      ///< unique in its graph, in letters that a person reads
};

/// A component of the state. Positions q_k are counted from 0 over the position slots; rates qd_k,
/// accelerations qdd_k, forces tau_k and directions over the degrees of freedom; kRotation as
/// rotationEntry() says. A direction is the sign of qd_k, and is differentiated as a constant.
enum class Input : std::uint8_t {
  kPosition,
  kCos,
  kSin,
  kVelocity,
  kAcceleration,
  kForce,
  kRotation,
  kDirection
};

/// Numbers the entries R_ij (i, j from 0) of a quaternion's rotation, which takes coordinates in
/// link axes to coordinates in joint axes.
/// @param slot  first component of the quaternion
constexpr int rotationEntry(int slot, int i, int j) {
  return 9 * slot + 3 * i + j;
}

/// What the derivative is taken with respect to: q_k, qd_k, qdd_k or R_ij.
struct Variable {
  /// kPosition (c_k and s_k follow it), kVelocity, kAcceleration, kForce or kRotation
  Input input;
  int joint;
};

/// A direction in which the state moves: dx/dt of each variable that moves.
using Direction = std::vector<std::pair<Variable, Node>>;

class Graph {
 public:
  Graph();

  // ---- leaves
  Node constant(const Rational& value);
  Node atom(const Atom& atom);  ///< the same name is the same atom
  Node input(Input input, int joint);

  // ---- operations; constants are folded, and +-0 and *1 leave no trace
  Node add(Node a, Node b);
  Node subtract(Node a, Node b) { return add(a, negate(b)); }
  Node multiply(Node a, Node b);
  Node negate(Node a);
  Node inverse(Node a);  ///< @throws std::invalid_argument when a is 0
  /// c_k a + s_k b
  Node turn(int joint, Node a, Node b);
  /// The sum of many terms; those with a factor c_k or s_k are gathered first, joint by joint.
  Node sum(const std::vector<Node>& terms);

  // ---- reading
  int size() const { return static_cast<int>(entries_.size()); }
  Op op(Node n) const { return entries_[n.index].op; }
  Node left(Node n) const { return {entries_[n.index].a}; }
  Node right(Node n) const { return {entries_[n.index].b}; }
  int joint(Node n) const { return entries_[n.index].joint; }  ///< of kInput and kTurn
  Input inputKind(Node n) const { return static_cast<Input>(entries_[n.index].a); }
  const Rational& value(Node n) const { return constants_[entries_[n.index].a]; }
  const Atom& atom(Node n) const { return atoms_[entries_[n.index].a]; }
  bool isConstant(Node n) const { return op(n) == Op::kConstant; }
  bool isZero(Node n) const { return n.index == 0; }
  bool isOne(Node n) const { return n.index == 1; }
  bool dependsOnState(Node n) const { return entries_[n.index].depends_on_state; }
  /// Operands of an operation (none, one or two). Those of kTurn leave out c_k and s_k.
  int operandCount(Node n) const;

  // ---- names of definitions, for people
  /// Calls a node by a name (the first name stays). Leaves and their negatives get none.
  void setName(Node n, const std::string& name);
  /// The name of a node, or "".
  const std::string& name(Node n) const;
  const std::map<int, std::string>& names() const { return names_; }

  // ---- derivatives
  /** Directional derivative  sum_i (dn/dx_i) direction_i  of many nodes, by forward mode. */
  std::vector<Node> directionalDerivative(const std::vector<Node>& nodes,
                                          const Direction& direction);
  /** All derivatives  dn/dx_i  of one node, by reverse mode: the result costs a small multiple of
      n itself, however many variables there are.
      @param atoms  numbers of the scene to differentiate by as well
      @return one a variable, then one an atom */
  std::vector<Node> gradient(Node n, const std::vector<Variable>& variables,
                             const std::vector<Node>& atoms = {});

 private:
  struct Entry {
    Op op;
    bool depends_on_state;
    int joint, a, b;
  };
  /// r times node, the form in which constants are collected.
  struct Scaled {
    Rational factor;
    Node node;
  };

  Node intern(Op op, int joint, int a, int b, bool depends_on_state);
  static std::size_t hashOf(const Entry& entry);
  void growBuckets();
  Node operation(Op op, Node a, Node b, int joint = 0);
  Node scale(const Rational& factor, Node n);
  Scaled scaled(Node n) const;
  /// n without its minus sign; *negative flips when there is one.
  Node withoutSign(Node n, bool* negative) const;
  /// Is n = trig * other, with trig the c_k (or s_k) of a joint?
  bool asTrigTimes(Node n, int* joint, bool* is_sine, Node* other) const;
  bool isTrig(Node n) const;
  Node trigDerivative(Node trig);  ///< d c_k / dq_k = -s_k,  d s_k / dq_k = c_k
  /// Nodes below the given ones, themselves included, in increasing order.
  std::vector<int> below(const std::vector<Node>& nodes) const;

  std::vector<Entry> entries_;
  std::vector<int> buckets_;  ///< of entries, found by hash; 0 (the number 0, found first): empty
  std::vector<Rational> constants_;
  std::unordered_map<Rational, int> constant_index_;  ///< hashed: to order rationals is to multiply
  std::vector<Atom> atoms_;
  std::map<std::string, int> atom_index_;
  std::map<int, std::string> names_;
};

/// A node together with its graph, so that formulas can be written as formulas.
struct Value {
  Graph* graph = nullptr;
  Node node;

  friend Value operator+(Value a, Value b) { return {a.graph, a.graph->add(a.node, b.node)}; }
  friend Value operator-(Value a, Value b) { return {a.graph, a.graph->subtract(a.node, b.node)}; }
  friend Value operator*(Value a, Value b) { return {a.graph, a.graph->multiply(a.node, b.node)}; }
  friend Value operator/(Value a, Value b) {
    return {a.graph, a.graph->multiply(a.node, a.graph->inverse(b.node))};
  }
  Value operator-() const { return {graph, graph->negate(node)}; }
  Value& operator+=(Value b) { return *this = *this + b; }
  Value& operator-=(Value b) { return *this = *this - b; }
};

}  // namespace dynwitness::symbolic
