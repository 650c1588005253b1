// SPDX-License-Identifier: GPL-3.0-or-later
// What a witness is asked about: a position, a velocity, and an acceleration or a force.
#pragma once

#include <cmath>
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
