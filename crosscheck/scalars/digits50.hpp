// SPDX-License-Identifier: GPL-3.0-or-later
// A float of 50 decimal digits that Eigen can hold.
#pragma once

#include <Eigen/Core>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/eigen_scalar.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {

/// The bare number type of Boost 1.74 does not compile with Eigen 3.4: it asks every matrix
/// expression whether it is a container of bytes.
class Digits50 {
 public:
  using Float = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>,
                                              boost::multiprecision::et_off>;
  Digits50() = default;
  Digits50(int value) : x_(value) {}     // NOLINT(google-explicit-constructor): exact
  Digits50(double value) : x_(value) {}  // NOLINT(google-explicit-constructor): exact
  explicit Digits50(const Float& x) : x_(x) {}
  const Float& value() const { return x_; }

  friend Digits50 operator+(const Digits50& a, const Digits50& b) { return Digits50(a.x_ + b.x_); }
  friend Digits50 operator-(const Digits50& a, const Digits50& b) { return Digits50(a.x_ - b.x_); }
  friend Digits50 operator*(const Digits50& a, const Digits50& b) { return Digits50(a.x_ * b.x_); }
  friend Digits50 operator/(const Digits50& a, const Digits50& b) { return Digits50(a.x_ / b.x_); }
  Digits50 operator-() const { return Digits50(-x_); }
  Digits50& operator+=(const Digits50& b) { return x_ += b.x_, *this; }
  Digits50& operator-=(const Digits50& b) { return x_ -= b.x_, *this; }
  Digits50& operator*=(const Digits50& b) { return x_ *= b.x_, *this; }
  Digits50& operator/=(const Digits50& b) { return x_ /= b.x_, *this; }
  friend bool operator==(const Digits50& a, const Digits50& b) { return a.x_ == b.x_; }
  friend Digits50 sqrt(const Digits50& a) { return Digits50(Float(sqrt(a.x_))); }
  friend Digits50 cos(const Digits50& a) { return Digits50(Float(cos(a.x_))); }
  friend Digits50 sin(const Digits50& a) { return Digits50(Float(sin(a.x_))); }

 private:
  Float x_ = 0;
};

inline Ball exactly(const Digits50& x) {
  return Ball(static_cast<scene::Rational>(x.value()));
}

}  // namespace dynwitness::crosscheck

namespace dynwitness::scene {
template <>
inline crosscheck::Digits50 fromExact<crosscheck::Digits50>(const Exact& x) {
  return crosscheck::Digits50(fromExact<crosscheck::Digits50::Float>(x));
}
}  // namespace dynwitness::scene

namespace Eigen {
template <>
struct NumTraits<dynwitness::crosscheck::Digits50>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::Digits50, 8, 100, 150> {};
}  // namespace Eigen
