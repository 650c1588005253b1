// SPDX-License-Identifier: GPL-3.0-or-later
// Motions that a scene prescribes: functions of time with their rates.
#pragma once

#include <cmath>
#include <stdexcept>
#include <type_traits>

#include "scene/numbers.hpp"
#include "scene/scene.hpp"

namespace dynwitness::scene {

/// A quantity and its first two rates at one time.
template <typename T>
struct Jet {
  T value, rate, second;  ///< [x], [x/s], [x/s^2]

  friend Jet operator-(const Jet& a) { return {-a.value, -a.rate, -a.second}; }
  friend Jet operator+(const Jet& a, const Jet& b) {
    return {a.value + b.value, a.rate + b.rate, a.second + b.second};
  }
  friend Jet operator-(const Jet& a, const Jet& b) { return a + (-b); }
  friend Jet operator*(const Jet& a, const Jet& b) {
    return {a.value * b.value, a.rate * b.value + a.value * b.rate,
            a.second * b.value + T(2) * a.rate * b.rate + a.value * b.second};
  }
  /// f(a), with f, f' and f'' at a
  Jet through(const T& f, const T& f1, const T& f2) const {
    return {f, f1 * rate, f1 * second + f2 * rate * rate};
  }
  friend Jet operator/(const Jet& a, const Jet& b) {
    const T inverse = T(1) / b.value;
    return a * b.through(inverse, -inverse * inverse, T(2) * inverse * inverse * inverse);
  }
};

/** The function of time f at t with f' and f'', by differentiating every operation (no
    differences).

    T with functions in <cmath> knows all; other scalars (rationals, fields) those without calls.
    @param number  the scene's numbers, as in buildModel
    @throws std::domain_error  outside the domain: sqrt at <= 0, asin beyond +-1 (their rates are
      infinite
            at the border), or a call that T does not know */
template <typename Numbers, typename T = typename Numbers::Scalar>
Jet<T> motionAt(const Expression& f, const Numbers& number, const T& t) {
  using Kind = Expression::Kind;
  const auto left = [&] { return motionAt(f.left(), number, t); };
  const auto right = [&] { return motionAt(f.right(), number, t); };
  switch (f.kind()) {
    case Kind::kNumber:
    case Kind::kParameter:
    case Kind::kPi:
      return {number(f), T(0), T(0)};
    case Kind::kTime:
      return {t, T(1), T(0)};
    case Kind::kNegate:
      return -left();
    case Kind::kAdd:
      return left() + right();
    case Kind::kSubtract:
      return left() - right();
    case Kind::kMultiply:
      return left() * right();
    case Kind::kDivide:
      return left() / right();
    case Kind::kPower: {
      const Jet<T> base = left(), one = {T(1), T(0), T(0)};
      Jet<T> product = one;
      for (int i = 0; i < (f.exponent() < 0 ? -f.exponent() : f.exponent()); ++i)
        product = product * base;
      return f.exponent() < 0 ? one / product : product;
    }
    case Kind::kCall:
      break;
  }
  const std::string& name = f.function();
  if constexpr (std::is_floating_point_v<T>) {
    const Jet<T> x = left();
    if (name == "sin") return x.through(std::sin(x.value), std::cos(x.value), -std::sin(x.value));
    if (name == "cos") return x.through(std::cos(x.value), -std::sin(x.value), -std::cos(x.value));
    if (name == "exp") return x.through(std::exp(x.value), std::exp(x.value), std::exp(x.value));
    if (name == "sqrt" && x.value > T(0)) {
      const T root = std::sqrt(x.value);
      return x.through(root, T(1) / (T(2) * root), -T(1) / (T(4) * root * x.value));
    }
    if (name == "asin" && std::abs(x.value) < T(1)) {
      const T c = std::sqrt((T(1) - x.value) * (T(1) + x.value));
      return x.through(std::asin(x.value), T(1) / c, x.value / (c * c * c));
    }
  }
  throw std::domain_error("motion \"" + f.text() + "\": outside the domain of " + name);
}

/// Checks driven joints and acceleration constraints: their motions exist at t = 0, their
/// directions are not zero, compliances not negative.
/// @throws InputError
void validateMotions(const Scene& scene);

}  // namespace dynwitness::scene
