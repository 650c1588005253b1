// SPDX-License-Identifier: GPL-3.0-or-later
// A scalar that computes nothing and writes down what would be computed: a sweep that runs on it
// becomes a straight-line program.
#pragma once

#include <stdexcept>

#include <Eigen/Core>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "scene/numbers.hpp"
#include "scene/state.hpp"
#include "symbolic/graph.hpp"

namespace dynwitness::crosscheck {

/** A value of a symbolic::Graph. Its operations ask the graph for nodes, which folds constants,
    drops what is multiplied by 0 or 1 and shares what was asked for before.

    All values live in the innermost Recording of the thread. */
class Traced {
 public:
  /// The graph that operations are written into while it exists.
  class Recording {
   public:
    explicit Recording(symbolic::Graph& graph) : outer_(current_) { current_ = &graph; }
    ~Recording() { current_ = outer_; }
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;

   private:
    symbolic::Graph* outer_;
  };

  Traced() = default;  ///< zero
  Traced(int value);   // NOLINT(google-explicit-constructor)
  explicit Traced(symbolic::Node node) : node_(node) {}
  static symbolic::Graph& graph() { return *current_; }

  symbolic::Node node() const { return node_; }

  friend Traced operator+(Traced a, Traced b) { return Traced(graph().add(a.node_, b.node_)); }
  friend Traced operator-(Traced a, Traced b) { return Traced(graph().subtract(a.node_, b.node_)); }
  friend Traced operator*(Traced a, Traced b) { return Traced(graph().multiply(a.node_, b.node_)); }
  /// Multiplies by 1 / b: whoever divides by the same number again does not divide again.
  /// @throws std::domain_error when b is 0 whatever the state is
  friend Traced operator/(Traced a, Traced b) {
    if (b == Traced()) throw std::domain_error("division by zero: a divisor is 0 in every state");
    return Traced(graph().multiply(a.node_, graph().inverse(b.node_)));
  }
  Traced operator-() const { return Traced(graph().negate(node_)); }
  Traced& operator+=(Traced b) { return *this = *this + b; }
  Traced& operator-=(Traced b) { return *this = *this - b; }
  Traced& operator*=(Traced b) { return *this = *this * b; }
  Traced& operator/=(Traced b) { return *this = *this / b; }
  /// The same node: equal formulas that are written differently are not equal here.
  friend bool operator==(Traced a, Traced b) { return a.node_ == b.node_; }
  friend bool operator!=(Traced a, Traced b) { return a.node_ != b.node_; }

 private:
  static thread_local symbolic::Graph* current_;
  symbolic::Node node_;
};

/** Gives a scene's exact numbers to Traced (the "Numbers" concept of scene/numbers.hpp): rationals
    as they are; pi, cosines and sines of fixed angles and the turns of slanted axes, where they are
    irrational, as atoms, which an angle and its negative share. The scene's named parameters are
    their values, or stay symbols: atoms of their names. Those of angles and axes are values. */
class TracedNumbers {
 public:
  using Scalar = Traced;
  explicit TracedNumbers(const scene::Mechanism& mechanism, bool fold_parameters = true)
      : values_(mechanism.parameterValues()), fold_parameters_(fold_parameters) {}

  Traced operator()(const scene::Number& number) const;
  scene::CosSin<Traced> angle(const scene::Number& radians) const;
  scene::AxisTurn<Traced> axisTurn(const scene::Vector& axis) const;

 private:
  scene::ParameterValues values_;
  bool fold_parameters_;
};

/// The state's components as inputs of the graph. A quaternion's four slots have no cosine and
/// sine.
scene::State<Traced> tracedState(const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::Traced>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::Traced, 1, 4, 4> {};
}  // namespace Eigen
