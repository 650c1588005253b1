// SPDX-License-Identifier: GPL-3.0-or-later
// A double that remembers how it came about, so that each rounding is weighed by what it does to
// the result.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

class AdjointError;

/** What a computation on AdjointError did, one node an inexact number: from which two it was made,
    how it changes with them, and what its own operation may have lost.

    Errors obey a linear recurrence, exactly. With hats on what is computed, D = hat - exact, and e
    the rounding of the operation itself:
        sum         D  =  D_a + D_b + e
        product     D  =  b^ D_a + a^ D_b + (e - D_a D_b)
        quotient    D  =  D_a / b^ - q^ D_b / b^ + (e + (D_a - q^ D_b) D_b / (b^ b))
        root        D  =  D_a / (2 r^) + (e - (r^ - r)^2 / (2 r^))
    so that the error of a result is  sum over nodes of  (d result / d node) (what stands in
    brackets), the derivatives being those of the computed numbers. Products of two errors are
    bounded by the running error bounds of the operands, which come along.

    A running error bound gives the sum over all paths of the products of magnitudes; here the
    products are added first. Turning a vector by R grows the former by up to sqrt(3), a chain of 64
    joints so by 1e10, and keeps the length of the latter. */
class AdjointTape {
 public:
  /// What is computed on AdjointError by this thread is written here, until the end of its scope.
  class Recording {
   public:
    explicit Recording(AdjointTape& tape) : outer_(current_) { current_ = &tape; }
    ~Recording() { current_ = outer_; }
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;

   private:
    AdjointTape* outer_;
  };
  static AdjointTape& current() { return *current_; }

  std::size_t size() const { return nodes_.size(); }
  /// Forgets what came after this size; numbers made since must not be used any more.
  void rewind(std::size_t size) { nodes_.resize(size); }

  /** For each of these numbers, how far it may be from the exact result. The derivatives are
      computed in double, each with at most as many roundings as there are nodes, 2 u of the sum
      over paths of magnitudes, which is the running error bound: so much is added. */
  Eigen::MatrixXd bounds(
      const Eigen::Matrix<AdjointError, Eigen::Dynamic, Eigen::Dynamic>& results) const;

  /** The same of sums  weights * results  (one row a sum), to first order: products of two errors
      are left out, so that nothing is asked of the running error bounds. With M as weights of an
      answer qdd these are the bounds of its residual: what is divided by on the way is multiplied
      by again. */
  Eigen::VectorXd firstOrder(
      const Eigen::MatrixXd& weights,
      const Eigen::Matrix<AdjointError, Eigen::Dynamic, Eigen::Dynamic>& results) const;

  /// a, b: nodes, or -1; own: the part of lost that is the operation's own rounding
  int add(int a, double by_a, int b, double by_b, double lost, double own) {
    nodes_.push_back({a, b, by_a, by_b, lost, own});
    return static_cast<int>(nodes_.size()) - 1;
  }

 private:
  struct Node {
    int a, b;
    double by_a, by_b;  ///< derivatives
    double lost;        ///< bound of what stands in brackets
    double own;         ///< bound of e
  };
  /// Derivatives of some results by the nodes that are still to be passed (adjoint_error.cpp).
  class Derivatives;
  /// Carries these derivatives back to all nodes up to `last`, and adds up what they make of each
  /// node's error.
  void carryBack(Derivatives& derivatives, int last, double Node::*error, double* sum) const;

  static inline thread_local AdjointTape* current_ = nullptr;

  std::vector<Node> nodes_;
};

/// A value with its running error bound, and its node on the tape: -1 for exact numbers.
class AdjointError {
 public:
  AdjointError() = default;
  AdjointError(double value) : x_(value) {}  // NOLINT(google-explicit-constructor): exact input
  AdjointError(int value) : x_(value) {}     // NOLINT(google-explicit-constructor)
  /// Input that is known to this bound.
  explicit AdjointError(const RunningError& x) : x_(x) {
    if (x.bound() > 0) node_ = AdjointTape::current().add(-1, 0, -1, 0, x.bound(), x.bound());
  }

  double value() const { return x_.value(); }
  const RunningError& running() const { return x_; }
  int node() const { return node_; }

  friend AdjointError operator+(const AdjointError& a, const AdjointError& b) {
    return made(a.x_ + b.x_, a, 1, b, 1, a.exactly() + b.exactly());
  }
  friend AdjointError operator-(const AdjointError& a, const AdjointError& b) {
    return made(a.x_ - b.x_, a, 1, b, -1, a.exactly() - b.exactly());
  }
  friend AdjointError operator*(const AdjointError& a, const AdjointError& b) {
    return made(a.x_ * b.x_, a, b.value(), b, a.value(), a.exactly() * b.exactly(),
                up(a.x_.bound() * b.x_.bound()));
  }
  friend AdjointError operator/(const AdjointError& a, const AdjointError& b) {
    const RunningError q = a.x_ / b.x_;
    const double room = std::abs(b.value()) - b.x_.bound();
    const double second = b.x_.bound() == 0
                              ? 0
                              : up((a.x_.bound() + std::abs(q.value()) * b.x_.bound()) *
                                   b.x_.bound() / (std::abs(b.value()) * room));
    return made(q, a, 1 / b.value(), b, -q.value() / b.value(), a.exactly() / b.exactly(),
                room > 0 ? second : kInfinite);
  }
  AdjointError operator-() const { return made(-x_, *this, -1, AdjointError(), 0, -exactly()); }
  AdjointError& operator+=(const AdjointError& b) { return *this = *this + b; }
  AdjointError& operator-=(const AdjointError& b) { return *this = *this - b; }
  AdjointError& operator*=(const AdjointError& b) { return *this = *this * b; }
  AdjointError& operator/=(const AdjointError& b) { return *this = *this / b; }

  friend AdjointError abs(const AdjointError& a) { return a.value() < 0 ? -a : a; }
  friend AdjointError sqrt(const AdjointError& a) {
    const RunningError root = sqrt(a.x_);
    const double error = root.bound();
    return made(root, a, 1 / (2 * root.value()), AdjointError(), 0, sqrt(a.exactly()),
                up(error * error / (2 * root.value())));
  }

  // order of the values, as RunningError has it
  friend bool operator==(const AdjointError& a, const AdjointError& b) { return a.x_ == b.x_; }
  friend bool operator!=(const AdjointError& a, const AdjointError& b) { return a.x_ != b.x_; }
  friend bool operator<(const AdjointError& a, const AdjointError& b) { return a.x_ < b.x_; }
  friend bool operator>(const AdjointError& a, const AdjointError& b) { return a.x_ > b.x_; }
  friend bool operator<=(const AdjointError& a, const AdjointError& b) { return a.x_ <= b.x_; }
  friend bool operator>=(const AdjointError& a, const AdjointError& b) { return a.x_ >= b.x_; }

 private:
  static constexpr double kInfinite = std::numeric_limits<double>::infinity();

  RunningError exactly() const { return x_.value(); }
  /// A product of bounds, in double, from above.
  static double up(double x) {
    return x == 0 ? 0 : x * RunningError::kInflate + RunningError::kTiny;
  }

  /// alone: the operation on exact operands; second: bound of the products of errors
  static AdjointError made(const RunningError& x, const AdjointError& a, double by_a,
                           const AdjointError& b, double by_b, const RunningError& alone,
                           double second = 0) {
    AdjointError out;
    out.x_ = x;
    if (x.bound() == 0) return out;
    const double own = alone.bound(), lost = own + second;
    // where nothing was lost and one operand passes unchanged, it is that operand
    if (lost == 0 && b.node_ < 0 && by_a == 1)
      out.node_ = a.node_;
    else if (lost == 0 && a.node_ < 0 && by_b == 1)
      out.node_ = b.node_;
    else
      out.node_ = AdjointTape::current().add(a.node_, by_a, b.node_, by_b, lost, own);
    return out;
  }

  RunningError x_;
  int node_ = -1;
};

/// Gives a scene's exact numbers to AdjointError, as RunningErrorNumbers does.
class AdjointErrorNumbers {
 public:
  using Scalar = AdjointError;
  explicit AdjointErrorNumbers(const scene::Mechanism& mechanism) : inner_(mechanism) {}

  AdjointError operator()(const scene::Number& number) const {
    return AdjointError(inner_(number));
  }
  scene::CosSin<AdjointError> angle(const scene::Number& radians) const {
    return lifted(inner_.angle(radians));
  }
  scene::AxisTurn<AdjointError> axisTurn(const scene::Vector& axis) const {
    const scene::AxisTurn<RunningError> turn = inner_.axisTurn(axis);
    return {lifted(turn.alpha), lifted(turn.beta)};
  }

 private:
  static scene::CosSin<AdjointError> lifted(const scene::CosSin<RunningError>& p) {
    return {AdjointError(p.c), AdjointError(p.s)};
  }
  RunningErrorNumbers inner_;
};

/// A state that carries bounds, on the tape.
scene::State<AdjointError> adjointState(const scene::State<RunningError>& state);

}  // namespace dynwitness::crosscheck

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::AdjointError>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::AdjointError, 2, 8, 12> {};
}  // namespace Eigen
