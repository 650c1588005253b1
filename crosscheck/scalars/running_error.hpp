// SPDX-License-Identifier: GPL-3.0-or-later
// A double that carries a bound on its own rounding error: where the limits of the checks come
// from.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <Eigen/Core>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {

/** value is computed exactly as in double arithmetic; bound is a proven upper limit of
    |value - x|, where x is the same expression in real numbers on exact input.

    One rounding of a result r is at most u |r|, u = 2^-53 (or half the smallest subnormal). Errors
    of operands are carried first order and second order: a b has |a| eb + |b| ea + ea eb. The bound
    is itself computed in double, so each operation inflates it by (1 + 8 u), more than its own few
    roundings can lose. What is exactly zero stays so, and adds nothing: structural zeros with a
    bound of some subnormal numbers would make most of a sweep's work theirs.

    A sweep on this type therefore returns the numbers of the double sweep and their limits.
    @see N. Higham, Accuracy and Stability of Numerical Algorithms (2002), section 3.3 */
class RunningError {
 public:
  static constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;
  static constexpr double kInflate = 1 + 8 * kUnitRoundoff;
  static constexpr double kTiny = std::numeric_limits<double>::denorm_min();

  RunningError() = default;
  RunningError(double value) : value_(value) {}  // NOLINT(google-explicit-constructor): exact input
  RunningError(int value) : value_(value) {}     // NOLINT(google-explicit-constructor)
  RunningError(double value, double bound) : value_(value), bound_(bound) {}

  double value() const { return value_; }
  double bound() const { return bound_; }

  friend RunningError operator+(const RunningError& a, const RunningError& b) {
    const double value = a.value_ + b.value_;
    if (a.isZero() || b.isZero()) return {value, a.bound_ + b.bound_};
    return rounded(value, a.bound_ + b.bound_, false, a, b);
  }
  friend RunningError operator-(const RunningError& a, const RunningError& b) {
    const double value = a.value_ - b.value_;
    if (a.isZero() || b.isZero()) return {value, a.bound_ + b.bound_};
    return rounded(value, a.bound_ + b.bound_, false, a, b);
  }
  friend RunningError operator*(const RunningError& a, const RunningError& b) {
    const double value = a.value_ * b.value_;
    if ((a.isZero() || b.isZero()) && value == 0) return value;
    return rounded(
        value, std::abs(a.value_) * b.bound_ + (std::abs(b.value_) + b.bound_) * a.bound_,
        (isPowerOfTwo(a.value_) || isPowerOfTwo(b.value_)) && std::isnormal(value), a, b);
  }
  friend RunningError operator/(const RunningError& a, const RunningError& b) {
    const double room = std::abs(b.value_) - b.bound_;  // at least this far from zero
    const double value = a.value_ / b.value_;
    if (!(room > 0)) return {value, std::numeric_limits<double>::infinity()};
    if (a.isZero()) return value;
    return rounded(value, (a.bound_ + std::abs(value) * kInflate * b.bound_) / room,
                   isPowerOfTwo(b.value_) && std::isnormal(value), a, b);
  }
  RunningError operator-() const { return {-value_, bound_}; }
  RunningError& operator+=(const RunningError& b) { return *this = *this + b; }
  RunningError& operator-=(const RunningError& b) { return *this = *this - b; }
  RunningError& operator*=(const RunningError& b) { return *this = *this * b; }
  RunningError& operator/=(const RunningError& b) { return *this = *this / b; }

  friend RunningError abs(const RunningError& a) { return {std::abs(a.value_), a.bound_}; }
  friend RunningError sqrt(const RunningError& a) {
    const double root = std::sqrt(a.value_);
    if (!(a.value_ > a.bound_)) return {root, std::numeric_limits<double>::infinity()};
    return rounded(root, a.bound_ / std::sqrt(a.value_ - a.bound_), false, a, a);
  }

  // order of the values: for Eigen's pivot searches, never inside a sweep
  friend bool operator==(const RunningError& a, const RunningError& b) {
    return a.value_ == b.value_;
  }
  friend bool operator!=(const RunningError& a, const RunningError& b) {
    return a.value_ != b.value_;
  }
  friend bool operator<(const RunningError& a, const RunningError& b) {
    return a.value_ < b.value_;
  }
  friend bool operator>(const RunningError& a, const RunningError& b) {
    return a.value_ > b.value_;
  }
  friend bool operator<=(const RunningError& a, const RunningError& b) {
    return a.value_ <= b.value_;
  }
  friend bool operator>=(const RunningError& a, const RunningError& b) {
    return a.value_ >= b.value_;
  }

 private:
  bool isZero() const { return value_ == 0 && bound_ == 0; }
  static RunningError rounded(double value, double carried, bool exact_operation,
                              const RunningError& a, const RunningError& b) {
    if (exact_operation && a.bound_ == 0 && b.bound_ == 0) return value;
    // 3 kTiny: the value and the bound itself may have lost half a subnormal at each step
    const double own = exact_operation ? 0.0 : kUnitRoundoff * std::abs(value);
    return {value, (carried + own) * kInflate + 3 * kTiny};
  }
  /// Of normal numbers: no digit after the leading one. (Products and quotients that leave the
  /// normal range are sorted out by their callers.)
  static bool isPowerOfTwo(double x) {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    return (bits & ((std::uint64_t{1} << 52) - 1)) == 0;
  }

  double value_ = 0, bound_ = 0;
};

/// Gives a scene's exact numbers to RunningError: each rounded once, with the distance it moved.
class RunningErrorNumbers {
 public:
  using Scalar = RunningError;
  explicit RunningErrorNumbers(const scene::Mechanism& mechanism)
      : values_(mechanism.parameterValues()) {}

  RunningError operator()(const scene::Number& number) const;
  scene::CosSin<RunningError> angle(const scene::Number& radians) const;
  scene::AxisTurn<RunningError> axisTurn(const scene::Vector& axis) const;

 private:
  scene::ParameterValues values_;
};

/// The joint position q with cos q and sin q from the C library, whose error glibc states as below
/// 1 ulp (2 u) on this platform.
scene::JointPosition<RunningError> runningErrorPosition(double q);
/// The same for a position that is not known exactly.
scene::JointPosition<RunningError> runningErrorPosition(const RunningError& q);

}  // namespace dynwitness::crosscheck

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::RunningError>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::RunningError, 2, 4, 8> {};
}  // namespace Eigen
