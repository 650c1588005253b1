// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/scalars/indeterminates.hpp"

namespace dynwitness::crosscheck {

const char* name(Parameters parameters) {
  return parameters == Parameters::kRandom ? "random" : "as written";
}

bool rationalRoot(const scene::Rational& square, scene::Rational* root) {
  const scene::Integer n = sqrt(scene::Integer(numerator(square)));
  const scene::Integer d = sqrt(scene::Integer(denominator(square)));
  *root = scene::Rational(n, d);
  return *root * *root == square;
}

}  // namespace dynwitness::crosscheck
