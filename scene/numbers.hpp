// SPDX-License-Identifier: GPL-3.0-or-later
// How a scalar type receives the exact numbers of a scene.
#pragma once

#include <cmath>
#include <limits>
#include <stdexcept>

#include <boost/math/constants/constants.hpp>

#include "scene/mechanism.hpp"
#include "scene/state.hpp"

namespace dynwitness::scene {

/// z turned into an axis: axis / |axis| = Rz(alpha) Ry(beta) (0, 0, 1)'.
template <typename T>
struct AxisTurn {
  CosSin<T> alpha, beta;
};

/// cos and sin of quarter turns k * pi/2, exactly.
template <typename T>
CosSin<T> quarterTurns(int k) {
  static constexpr int kCos[] = {1, 0, -1, 0}, kSin[] = {0, 1, 0, -1};
  const int i = ((k % 4) + 4) % 4;
  return {T(kCos[i]), T(kSin[i])};
}

/// k when the exact angle is k * pi/2, told apart from every other angle without rounding.
bool isQuarterTurn(const Exact& angle, int* k);

/// The T nearest to an exact number (within an ulp or two for types wider than double).
template <typename T>
T fromExact(const Exact& x) {
  T value = T(x.rational.convert_to<T>());
  if (x.pi_multiple != 0)
    value += T(x.pi_multiple.convert_to<T>()) * boost::math::constants::pi<T>();
  return value;
}
template <>
inline double fromExact<double>(const Exact& x) {
  return x.toDouble();
}
template <>
inline float fromExact<float>(const Exact& x) {
  return static_cast<float>(x.toDouble());
}
template <>
long double fromExact<long double>(const Exact& x);

/** Gives a scene's numbers to a real scalar type: double, float, long double, multiprecision.

    This is the interface ("Numbers") that models and programs are built through; other arithmetics
    (prime field, balls, running error bounds) bring a class with the same three members. */
template <typename T>
class RealNumbers {
 public:
  using Scalar = T;
  explicit RealNumbers(const Mechanism& mechanism) : values_(mechanism.parameterValues()) {}

  /// An expression's value: evaluated exactly, rounded once.
  T operator()(const Number& number) const { return fromExact<T>(exactValue(number, values_)); }

  /// cos and sin of a fixed angle; exact at multiples of pi/2.
  CosSin<T> angle(const Number& radians) const {
    using std::cos;
    using std::sin;
    const Exact exact = exactValue(radians, values_);
    int k = 0;
    if (isQuarterTurn(exact, &k)) return quarterTurns<T>(k);
    const T value = fromExact<T>(exact);
    return {cos(value), sin(value)};
  }

  /// The turn that takes z to an axis of any non-zero length; exact for coordinate axes.
  AxisTurn<T> axisTurn(const Vector& axis) const {
    using std::sqrt;
    const T x = (*this)(axis[0]), y = (*this)(axis[1]), z = (*this)(axis[2]);
    const T rho = sqrt(x * x + y * y), length = sqrt(x * x + y * y + z * z);
    if (length == T(0)) throw std::invalid_argument("axisTurn: axis: expected a non-zero vector");
    const CosSin<T> alpha = rho == T(0) ? CosSin<T>{T(1), T(0)} : CosSin<T>{x / rho, y / rho};
    return {alpha, {z / length, rho / length}};
  }

 private:
  ParameterValues values_;
};

}  // namespace dynwitness::scene
