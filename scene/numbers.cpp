// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled once: arithmetic of rationals takes long to compile, and most files give numbers to a
// scalar.
#include "scene/numbers.hpp"

#include "scene/rational_signs.hpp"

namespace dynwitness::scene {

bool isQuarterTurn(const Exact& angle, int* k) {
  if (!isZero(angle.rational)) return false;
  const Rational turns = angle.pi_multiple * 2;
  if (bottom(turns) != 1) return false;
  *k = static_cast<int>(Integer(numerator(turns) % 4));
  return true;
}

template <>
long double fromExact<long double>(const Exact& x) {
  auto value = x.rational.convert_to<long double>();
  if (!isZero(x.pi_multiple))
    value += x.pi_multiple.convert_to<long double>() * boost::math::constants::pi<long double>();
  return value;
}

}  // namespace dynwitness::scene
