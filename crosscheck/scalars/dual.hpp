// SPDX-License-Identifier: GPL-3.0-or-later
// Dual numbers over any scalar: a value and its exact first derivative.
#pragma once

#include <type_traits>

#include <Eigen/Core>

#include "crosscheck/scalars/eigen_scalar.hpp"
#include "scene/numbers.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// a + b eps with eps^2 = 0: running a sweep on it differentiates the sweep, without any step size.
template <typename T>
struct Dual {
  T value = T(0), derivative = T(0);

  Dual() = default;
  Dual(const T& v) : value(v) {}  // NOLINT(google-explicit-constructor): constants are duals
  /// Whatever T can be made of, through T: a double reaches duals of duals whole, not as an int.
  template <typename U, typename = std::enable_if_t<!std::is_same_v<U, T> &&
                                                    std::is_constructible_v<T, const U&>>>
  explicit Dual(const U& v) : value(T(v)) {}
  Dual(const T& v, const T& d) : value(v), derivative(d) {}

  friend Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.derivative + b.derivative};
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.derivative - b.derivative};
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.derivative * b.value + a.value * b.derivative};
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T quotient = a.value / b.value;
    return {quotient, (a.derivative - quotient * b.derivative) / b.value};
  }
  Dual operator-() const { return {-value, -derivative}; }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator-=(const Dual& b) { return *this = *this - b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }
  Dual& operator/=(const Dual& b) { return *this = *this / b; }
  friend bool operator==(const Dual& a, const Dual& b) {
    return a.value == b.value && a.derivative == b.derivative;
  }
  friend bool operator!=(const Dual& a, const Dual& b) { return !(a == b); }
};

/// That of the value: between its jumps a sign does not change.
template <typename T>
int directionOf(const Dual<T>& rate) {
  using scene::directionOf;
  return directionOf(rate.value);
}

/// A joint position moving with velocity qd: d cos q = -sin q qd, d sin q = cos q qd.
template <typename T>
scene::JointPosition<Dual<T>> moving(const scene::JointPosition<T>& x, const T& qd) {
  return {{x.q, qd}, {x.c, -x.s * qd}, {x.s, x.c * qd}};
}

/// Gives a scene's numbers to Dual<T> as constants, through the Numbers of T.
template <typename Numbers>
class DualNumbers {
 public:
  using Inner = typename Numbers::Scalar;
  using Scalar = Dual<Inner>;
  explicit DualNumbers(const Numbers& inner) : inner_(inner) {}

  Scalar operator()(const scene::Number& number) const { return inner_(number); }
  scene::CosSin<Scalar> angle(const scene::Number& radians) const {
    return lifted(inner_.angle(radians));
  }
  scene::AxisTurn<Scalar> axisTurn(const scene::Vector& axis) const {
    const scene::AxisTurn<Inner> turn = inner_.axisTurn(axis);
    return {lifted(turn.alpha), lifted(turn.beta)};
  }

 private:
  static scene::CosSin<Scalar> lifted(const scene::CosSin<Inner>& p) { return {p.c, p.s}; }
  const Numbers& inner_;
};

}  // namespace dynwitness::crosscheck

namespace Eigen {
template <typename T>
struct NumTraits<dynwitness::crosscheck::Dual<T>>
    : dynwitness::crosscheck::EigenScalar<dynwitness::crosscheck::Dual<T>, 2, 4, 12> {};
}  // namespace Eigen
