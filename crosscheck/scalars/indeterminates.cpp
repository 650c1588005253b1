// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/indeterminates.hpp"

namespace dynwitness::crosscheck {

const char* name(Parameters parameters) {
  return parameters == Parameters::kRandom ? "random" : "as written";
}

namespace detail {
namespace {

scene::Integer floorOf(const scene::Rational& x) {
  const scene::Integer n = numerator(x), d = denominator(x), quotient = n / d;
  return n < 0 && quotient * d != n ? scene::Integer(quotient - 1) : quotient;
}

}  // namespace

ReducedAngle reduced(const scene::Exact& given) {
  scene::Exact angle = given;
  if (angle.rational == 0)  // between -pi and pi, so that whole turns do not change the sign
    angle.pi_multiple -= 2 * floorOf((angle.pi_multiple + 1) / 2);
  ReducedAngle out{angle.rational < 0 || (angle.rational == 0 && angle.pi_multiple < 0), 0, false,
                   angle};
  if (out.negative) out.rest = {-angle.rational, -angle.pi_multiple};
  scene::Integer quarters = floorOf(out.rest.pi_multiple * 2);
  out.rest.pi_multiple -= scene::Rational(quarters, 2);
  // between pi/4 and pi/2: as far below pi/2
  if (out.rest.rational == 0 && out.rest.pi_multiple > scene::Rational(1, 4)) {
    out.rest.pi_multiple = scene::Rational(1, 2) - out.rest.pi_multiple;
    out.mirrored = true;
    ++quarters;
  }
  out.quarters = static_cast<int>(scene::Integer(((quarters % 4) + 4) % 4));
  return out;
}

bool rationalRoot(const scene::Rational& square, scene::Rational* root) {
  const scene::Integer n = sqrt(scene::Integer(numerator(square)));
  const scene::Integer d = sqrt(scene::Integer(denominator(square)));
  *root = scene::Rational(n, d);
  return *root * *root == square;
}

}  // namespace detail
}  // namespace dynwitness::crosscheck
