// SPDX-License-Identifier: GPL-3.0-or-later
// What a witness is asked about: a position, a velocity, and an acceleration or a force.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace dynwitness::scene {

/// Cosine and sine of one angle: a point of the circle c^2 + s^2 = 1.
template <typename T>
struct CosSin {
  T c, s;
};

/** One position slot. Witnesses read c and s where a joint turns and q where it slides (or where a
    spring measures it, or where it is a component of a quaternion), so every quantity is a rational
    function of the three, and a position need not come from a floating-point angle. */
template <typename T>
struct JointPosition {
  T q, c, s;
};

template <typename T>
JointPosition<T> jointPosition(const T& q) {
  using std::cos;
  using std::sin;
  return {q, cos(q), sin(q)};
}

namespace detail {
template <typename T, typename = void>
struct HasOrder : std::false_type {};
template <typename T>
struct HasOrder<T, std::void_t<decltype(bool(std::declval<const T&>() < std::declval<const T&>()))>>
    : std::true_type {};
}  // namespace detail

namespace detail {
/// The floating-point type of a scalar that is such a number, or carries one beside its error as
/// value(); void of others.
template <typename T, typename = void>
struct Floating {
  using Type = void;
};
template <typename T>
struct Floating<T, std::enable_if_t<std::is_floating_point_v<T>>> {
  using Type = T;
  static Type of(const T& x) { return x; }
};
template <typename T>
struct Floating<T, std::enable_if_t<std::is_floating_point_v<
                       std::decay_t<decltype(std::declval<const T&>().value())>>>> {
  using Type = std::decay_t<decltype(std::declval<const T&>().value())>;
  static Type of(const T& x) { return x.value(); }
};
}  // namespace detail

/** The quaternion (w, x, y, z) that starts at this slot, or, where its square is not a normal
    number, that times the power of two that brings its largest component to [1/2, 1): its rotation
    is the same, and a power of two rounds nothing. Elements of a field and other scalars without a
    largest number are left as they are. */
template <typename T>
std::array<T, 4> quaternionAt(const JointPosition<T>* slot) {
  std::array<T, 4> q = {slot[0].q, slot[1].q, slot[2].q, slot[3].q};
  using Floating = detail::Floating<T>;
  if constexpr (!std::is_void_v<typename Floating::Type>) {
    using F = typename Floating::Type;
    F square = 0;
    for (const T& component : q) square += Floating::of(component) * Floating::of(component);
    if (std::isnormal(square)) return q;
    F largest = 0;
    for (const T& component : q) largest = std::max(largest, std::abs(Floating::of(component)));
    if (largest == 0 || !std::isfinite(largest)) return q;
    int exponent = 0;
    std::frexp(largest, &exponent);
    // the power itself has to be a normal number
    const F power = std::ldexp(F(1), std::min(-exponent, std::numeric_limits<F>::max_exponent - 1));
    for (T& component : q) component = component * T(power);
  }
  return q;
}

/** Which way a joint moves: the sign of its rate, 0 at rest. Elements of a field (and other scalars
    without an order) have no sign: there it is given as 1, so that what is computed is the case in
    which every joint moves forward. */
template <typename T>
int directionOf(const T& rate) {
  if constexpr (detail::HasOrder<T>::value)
    return rate > T(0) ? 1 : rate < T(0) ? -1 : 0;
  else
    return 1;
}

/// One state, SI units, in the order of the joints: Mechanism::positions() slots x, and
/// Mechanism::dof() of each of the others.
template <typename T>
struct State {
  std::vector<JointPosition<T>> x;
  std::vector<T> qd;   ///< [rad/s], [m/s]
  std::vector<T> qdd;  ///< asked with `tau` [rad/s^2], [m/s^2]
  std::vector<T> tau;  ///< asked with `qdd` [N m], [N]
};

}  // namespace dynwitness::scene
