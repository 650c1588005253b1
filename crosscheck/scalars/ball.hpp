// SPDX-License-Identifier: GPL-3.0-or-later
// Real numbers as balls [midpoint +- radius] of any precision: what the certified truth is computed
// in.
#pragma once

#include <stdexcept>
#include <string>

#include <arb.h>
#include <Eigen/Core>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {

/// Sets the precision [bits] that balls of this thread are computed with, until the end of its
/// scope.
class BallPrecision {
 public:
  explicit BallPrecision(long bits) : outer_(bits_) { bits_ = bits; }
  ~BallPrecision() { bits_ = outer_; }
  BallPrecision(const BallPrecision&) = delete;
  BallPrecision& operator=(const BallPrecision&) = delete;

  static long bits() { return bits_; }

 private:
  long outer_;
  static inline thread_local long bits_ = 128;
};

/** A set of real numbers [midpoint - radius, midpoint + radius] that encloses x, the value of the
    same expression in real numbers. Every operation rounds the midpoint at BallPrecision::bits()
    and widens the radius by what rounding may have lost, so enclosure is a theorem and no
    estimate. A division by a ball that contains zero gives a ball that is not finite. (Arb's
    arb_t, with C++ operators.)

    @see F. Johansson, Arb: efficient arbitrary-precision midpoint-radius interval arithmetic,
         IEEE Trans. Computers 66 (2017) */
class Ball {
 public:
  Ball() { arb_init(x_); }
  Ball(int value) : Ball() { arb_set_si(x_, value); }  // NOLINT(google-explicit-constructor): exact
  Ball(double value) : Ball() {
    arb_set_d(x_, value);
  }                         // NOLINT(google-explicit-constructor): exact
  Ball(long double value);  // NOLINT(google-explicit-constructor): exact
  explicit Ball(const scene::Rational& value);
  Ball(const Ball& other) : Ball() { arb_set(x_, other.x_); }
  Ball(Ball&& other) noexcept : Ball() { arb_swap(x_, other.x_); }
  Ball& operator=(const Ball& other) {
    arb_set(x_, other.x_);
    return *this;
  }
  Ball& operator=(Ball&& other) noexcept {
    arb_swap(x_, other.x_);
    return *this;
  }
  ~Ball() { arb_clear(x_); }

  static Ball pi();

  friend Ball operator+(const Ball& a, const Ball& b) {
    Ball r;
    arb_add(r.x_, a.x_, b.x_, BallPrecision::bits());
    return r;
  }
  friend Ball operator-(const Ball& a, const Ball& b) {
    Ball r;
    arb_sub(r.x_, a.x_, b.x_, BallPrecision::bits());
    return r;
  }
  friend Ball operator*(const Ball& a, const Ball& b) {
    Ball r;
    arb_mul(r.x_, a.x_, b.x_, BallPrecision::bits());
    return r;
  }
  friend Ball operator/(const Ball& a, const Ball& b) {
    Ball r;
    arb_div(r.x_, a.x_, b.x_, BallPrecision::bits());
    return r;
  }
  Ball operator-() const {
    Ball r;
    arb_neg(r.x_, x_);
    return r;
  }
  Ball& operator+=(const Ball& b) { return *this = *this + b; }
  Ball& operator-=(const Ball& b) { return *this = *this - b; }
  Ball& operator*=(const Ball& b) { return *this = *this * b; }
  Ball& operator/=(const Ball& b) { return *this = *this / b; }

  /// Certainly the same number: both exact. (Eigen asks it of imaginary parts.)
  friend bool operator==(const Ball& a, const Ball& b) { return arb_eq(a.x_, b.x_); }

  friend Ball abs(const Ball& a);
  friend Ball sqrt(const Ball& a);
  friend scene::CosSin<Ball> cosSin(const Ball& angle);

  bool isFinite() const { return arb_is_finite(x_); }
  bool isExact() const { return arb_is_exact(x_); }        ///< radius 0
  bool isZero() const { return arb_is_zero(x_); }          ///< exactly 0
  bool isPositive() const { return arb_is_positive(x_); }  ///< every number in it
  bool containsZero() const { return arb_contains_zero(x_); }
  bool contains(const scene::Rational& value) const;
  /// Whether radius < 2^-bits |x| for every x in the ball.
  bool isSharp(long bits) const;

  double mid() const;     ///< the double nearest to the midpoint
  double radius() const;  ///< rounded up
  /// Bounds of |x| over the ball, rounded outward: atLeast() <= |x| <= atMost().
  double atLeast() const;
  double atMost() const;
  /// "[3.14159 +/- 2.7e-6]"
  std::string text(int digits = 20) const;

 private:
  arb_t x_;
};

/// The sign of a rate (scene::directionOf).
/// @throws std::domain_error  the ball holds 0 and other numbers
inline int directionOf(const Ball& rate) {
  if (rate.isZero()) return 0;
  if (rate.containsZero()) throw std::domain_error("directionOf: the sign of a rate is not known");
  return rate.isPositive() ? 1 : -1;
}

/// Gives a scene's exact numbers to Ball, enclosed at the precision of the moment.
class BallNumbers {
 public:
  using Scalar = Ball;
  explicit BallNumbers(const scene::Mechanism& mechanism) : values_(mechanism.parameterValues()) {}

  Ball operator()(const scene::Number& number) const;
  scene::CosSin<Ball> angle(const scene::Number& radians) const;
  scene::AxisTurn<Ball> axisTurn(const scene::Vector& axis) const;

 private:
  scene::ParameterValues values_;
};

/// A state of doubles as exact input, with cos q and sin q enclosed at the precision of the moment.
scene::State<Ball> ballState(const scene::State<double>& state);
/// The same of a mechanism where joints may follow others: those are where the leaders' doubles put
/// them, and not at the doubles beside that.
scene::State<Ball> ballState(const scene::State<double>& state, const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::Ball>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::Ball, 8, 40, 60> {};
}  // namespace Eigen
