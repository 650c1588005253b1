// SPDX-License-Identifier: GPL-3.0-or-later
// How the families write their mechanisms down.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "crosscheck/stability/family.hpp"

namespace dynwitness::crosscheck::stability {

using Words = std::array<std::string, 3>;

inline scene::Number number(const std::string& text) {
  return scene::Expression::parse(text);
}
inline scene::Vector vectorOf(const Words& words) {
  return {number(words[0]), number(words[1]), number(words[2])};
}

/// A link in numbers; what is not said is zero.
struct LinkWords {
  int parent = 0;
  scene::JointKind joint = scene::JointKind::kRevolute;
  Words xyz = {"0", "0", "0"};                                  ///< of the joint on the parent [m]
  Words axis = {"0", "0", "1"};                                 ///< in the joint frame
  std::string mass = "0";                                       ///< [kg]
  Words com = {"0", "0", "0"};                                  ///< [m]
  Words moments = {"0", "0", "0"}, products = {"0", "0", "0"};  ///< xx, yy, zz; xy, xz, yz [kg m^2]
  std::string rotor = "0", gear = "1";                          ///< [kg m^2]
};

/// A mechanism of these links at a state (all of its slots; missing rates and forces are zero).
Case caseOf(const std::string& family, const std::vector<LinkWords>& links, const Words& gravity,
            const std::vector<double>& q, std::vector<double> qd, std::vector<double> tau);

/// Root mean square of the sum of so many roundings, each uniform up to the unit roundoff.
inline double rounded(int roundings, const Arithmetic& numbers) {
  return numbers.unit * std::sqrt(roundings / 3.0);
}

/// Figures of the variants: lengths [m], moments of inertia [kg m^2].
inline constexpr const char* kLength[kVariants] = {"0.7", "0.63", "0.83"};
inline constexpr const char* kMoment[kVariants] = {"0.3", "0.37", "0.29"};

/// Nothing cancels, until the square of s is no number of the arithmetic any more.
inline double untilItsSquareOverflows(double s, const Arithmetic& numbers) {
  return s > std::sqrt(numbers.largest) ? 1 : numbers.unit;
}

/// What is lost is a rounding of the answer.
inline double nothingCancels(double, const Arithmetic& numbers) {
  return numbers.unit;
}

/// What is particular to some methods: kernels and derived equations fold exact numbers before they
/// round, an engine has a limit of its own.
inline Theory theoryOf(std::vector<std::string> methods, std::string formula,
                       std::function<double(double, const Arithmetic&)> error) {
  return {Road::kAny, std::move(formula), std::move(error), std::move(methods)};
}
inline Theory noTheoryOf(std::vector<std::string> methods, std::string why) {
  return theoryOf(std::move(methods), std::move(why), {});
}

/// The worst error of the variants; what is no number is worst.
template <typename Error>
double worstOf(const Error& error) {
  double worst = 0;
  for (int v = 0; v < kVariants && !std::isnan(worst); ++v)
    if (const double one = error(v); !(one <= worst)) worst = one;
  return worst;
}

inline Words noGravity() {
  return {"0", "0", "0"};
}
inline Words gravityDown() {
  return {"0", "0", "-9.81"};
}
inline Words gravitySideways() {
  return {"0", "-9.81", "0"};
}

}  // namespace dynwitness::crosscheck::stability
