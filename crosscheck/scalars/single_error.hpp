// SPDX-License-Identifier: GPL-3.0-or-later
// A float that carries a bound on its own rounding error: for sweeps in single precision.
#pragma once

#include <cmath>

#include "crosscheck/scalars/running_error.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** value is computed exactly as in float arithmetic; bound is a proven upper limit of |value - x|,
    where x is the same expression in real numbers on the input before it was rounded to float.

    Every operation is done twice. RunningError does it on the same operands and says by how much
    the real result may differ from the double r; then
        |value - x| <= |value - r| + |r - x|,
    whose first part is what this one rounding to float has moved, known to the last digit instead
    of estimated by u |r|. What overflows a float has an infinite bound. */
class SingleError {
 public:
  SingleError() = default;
  SingleError(int value)
      : SingleError(static_cast<double>(value)) {}  // NOLINT(google-explicit-constructor)
  /// x, rounded.
  SingleError(double x)
      : SingleError(static_cast<float>(x), x) {}  // NOLINT(google-explicit-constructor)
  /// A float that stands for the number x.
  SingleError(float value, const RunningError& x)
      : inner_(value, (x.bound() + std::abs(value - x.value())) * RunningError::kInflate) {}

  float value() const { return static_cast<float>(inner_.value()); }
  double bound() const { return inner_.bound(); }

  friend SingleError operator+(const SingleError& a, const SingleError& b) {
    return {a.value() + b.value(), a.inner_ + b.inner_};
  }
  friend SingleError operator-(const SingleError& a, const SingleError& b) {
    return {a.value() - b.value(), a.inner_ - b.inner_};
  }
  friend SingleError operator*(const SingleError& a, const SingleError& b) {
    return {a.value() * b.value(), a.inner_ * b.inner_};
  }
  friend SingleError operator/(const SingleError& a, const SingleError& b) {
    return {a.value() / b.value(), a.inner_ / b.inner_};
  }
  SingleError operator-() const { return {-value(), -inner_}; }
  SingleError& operator+=(const SingleError& b) { return *this = *this + b; }
  SingleError& operator-=(const SingleError& b) { return *this = *this - b; }
  SingleError& operator*=(const SingleError& b) { return *this = *this * b; }
  SingleError& operator/=(const SingleError& b) { return *this = *this / b; }

  friend SingleError abs(const SingleError& a) {
    SingleError size;
    size.inner_ = abs(a.inner_);
    return size;
  }

  // order of the values: where a sweep asks for the direction of a rate, and Eigen for a pivot
  friend bool operator==(const SingleError& a, const SingleError& b) {
    return a.inner_ == b.inner_;
  }
  friend bool operator!=(const SingleError& a, const SingleError& b) {
    return a.inner_ != b.inner_;
  }
  friend bool operator<(const SingleError& a, const SingleError& b) { return a.inner_ < b.inner_; }
  friend bool operator>(const SingleError& a, const SingleError& b) { return a.inner_ > b.inner_; }
  friend bool operator<=(const SingleError& a, const SingleError& b) {
    return a.inner_ <= b.inner_;
  }
  friend bool operator>=(const SingleError& a, const SingleError& b) {
    return a.inner_ >= b.inner_;
  }

 private:
  RunningError inner_;
};

/// A scene's numbers as scene::RealNumbers<float> has them, each with its distance from the truth.
class SingleErrorNumbers {
 public:
  using Scalar = SingleError;
  explicit SingleErrorNumbers(const scene::Mechanism& mechanism)
      : rounded_(mechanism), known_(mechanism) {}

  SingleError operator()(const scene::Number& number) const {
    return {rounded_(number), known_(number)};
  }
  scene::CosSin<SingleError> angle(const scene::Number& radians) const {
    return pair(rounded_.angle(radians), known_.angle(radians));
  }
  scene::AxisTurn<SingleError> axisTurn(const scene::Vector& axis) const {
    const scene::AxisTurn<float> value = rounded_.axisTurn(axis);
    const scene::AxisTurn<RunningError> known = known_.axisTurn(axis);
    return {pair(value.alpha, known.alpha), pair(value.beta, known.beta)};
  }

 private:
  static scene::CosSin<SingleError> pair(const scene::CosSin<float>& value,
                                         const scene::CosSin<RunningError>& known) {
    return {{value.c, known.c}, {value.s, known.s}};
  }

  scene::RealNumbers<float> rounded_;
  RunningErrorNumbers known_;
};

}  // namespace dynwitness::crosscheck

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::SingleError>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::SingleError, 2, 8, 12> {};
}  // namespace Eigen
