// SPDX-License-Identifier: GPL-3.0-or-later
// Random rational points at which equations are checked exactly.
#pragma once

#include <algorithm>
#include <random>
#include <string>

#include "scene/numbers.hpp"
#include "scene/state.hpp"
#include "symbolic/graph.hpp"

namespace dynwitness::symbolic {

/// A small random rational that is not 0.
inline Rational randomRational(std::mt19937& random) {
  const int numerator = static_cast<int>(random() % 19) + 1;
  const int denominator = static_cast<int>(random() % 7) + 1;
  return Rational(random() % 2 == 0 ? numerator : -numerator, denominator);
}

/// A rational point of the circle: ((1 - t^2)/(1 + t^2), 2 t/(1 + t^2)).
inline scene::CosSin<Rational> randomCirclePoint(std::mt19937& random) {
  const Rational t = randomRational(random), d = 1 + t * t;
  return {(1 - t * t) / d, 2 * t / d};
}

/** A scene's numbers as exact rationals. Three kinds have no rational value, and something else
    stands in for them: random points of the circle for angles that are not multiples of pi/2 and
    for oblique axes, 22/7 for pi. An identity that holds at such points holds for the true values
    too, since the equations are polynomials in these numbers and use of them c^2 + s^2 = 1 alone.
    */
class ExactNumbers {
 public:
  using Scalar = Rational;
  explicit ExactNumbers(const scene::Mechanism& mechanism, unsigned seed = 0)
      : values_(mechanism.parameterValues()), seed_(seed) {}

  Rational operator()(const scene::Number& number) const {
    const scene::Exact exact = exactValue(number, values_);
    return exact.rational + exact.pi_multiple * Rational(22, 7);
  }

  /// The same angle is the same point in every call; opposite angles are mirrored points.
  scene::CosSin<Rational> angle(const scene::Number& radians) const {
    scene::Exact exact = exactValue(radians, values_);
    int quarter = 0;
    if (scene::isQuarterTurn(exact, &quarter)) return scene::quarterTurns<Rational>(quarter);
    const bool negative = exact.approximation() < 0;
    if (negative) exact = {-exact.rational, -exact.pi_multiple};
    auto point = pointFor(exact.rational.str() + "+" + exact.pi_multiple.str());
    if (negative) point.s = -point.s;
    return point;
  }

  scene::AxisTurn<Rational> axisTurn(const scene::Vector& axis) const {
    const std::string key =
        "(" + axis[0].text() + "," + axis[1].text() + "," + axis[2].text() + ")";
    return {pointFor("alpha" + key), pointFor("beta" + key)};
  }

 private:
  scene::CosSin<Rational> pointFor(const std::string& key) const {
    unsigned h = 2166136261u + seed_;
    for (char ch : key) h = (h ^ static_cast<unsigned char>(ch)) * 16777619u;
    std::mt19937 random(h);
    return randomCirclePoint(random);
  }

  scene::ParameterValues values_;
  unsigned seed_;
};

/// A state with random rational components, angles on the circle; quaternions are any.
inline scene::State<Rational> exactState(int dof, unsigned seed, int positions = 0) {
  std::mt19937 random(seed);
  scene::State<Rational> state;
  for (int i = 0; i < std::max(dof, positions); ++i) {
    const scene::CosSin<Rational> point = randomCirclePoint(random);
    state.x.push_back({randomRational(random), point.c, point.s});
    if (i >= dof) continue;
    state.qd.push_back(randomRational(random));
    state.qdd.push_back(randomRational(random));
  }
  return state;
}

}  // namespace dynwitness::symbolic
