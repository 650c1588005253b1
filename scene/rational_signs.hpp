// SPDX-License-Identifier: GPL-3.0-or-later
// What is asked of rationals most often, read off their two integers: Boost 1.74 divides to compare
// a rational with another number, and to find its sign.
#pragma once

#include "scene/expression.hpp"

namespace dynwitness::scene {

inline const Integer& top(const Rational& x) {
  return x.backend().data().numerator();
}
inline const Integer& bottom(const Rational& x) {
  return x.backend().data().denominator();
}
inline bool isZero(const Rational& x) {
  return top(x).is_zero();
}
inline bool isNegative(const Rational& x) {
  return top(x).sign() < 0;
}
/// 1 or -1
inline bool isUnit(const Rational& x) {
  const auto isOneLimb = [](const Integer& n) {
    return n.backend().size() == 1 && *n.backend().limbs() == 1;
  };
  return isOneLimb(top(x)) && isOneLimb(bottom(x));
}
/// In lowest terms, as all are.
inline bool areEqual(const Rational& a, const Rational& b) {
  return top(a) == top(b) && bottom(a) == bottom(b);
}

/// Whether rational + pi_multiple pi is below zero; digits of pi are asked for only where the two
/// have different signs.
inline bool isNegative(const Exact& x) {
  if (isZero(x.pi_multiple)) return isNegative(x.rational);
  const bool by_pi = isNegative(x.pi_multiple);
  if (isZero(x.rational) || isNegative(x.rational) == by_pi) return by_pi;
  return isNegative(x.approximation());
}

}  // namespace dynwitness::scene
