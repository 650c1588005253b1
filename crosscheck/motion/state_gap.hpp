// SPDX-License-Identifier: GPL-3.0-or-later
// How far two states of a mechanism are apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Worst of many: NaN is worse than all numbers and stays. @return whether d was taken
template <typename T>
bool keepWorse(T* worst, T d) {
  if (std::isnan(*worst) || d <= *worst) return false;
  *worst = d;
  return true;
}

/** (q, qd) of y = (q, qd, work) with quaternions of length 1: that of a quaternion says nothing of
    where a link is. @param like  nothing, or (q, ..), whose of the two signs quaternions get */
template <typename T>
std::vector<long double> placed(const scene::Mechanism& mechanism, const std::vector<T>& y,
                                const std::vector<long double>& like = {}) {
  std::vector<long double> out(y.begin(), y.end() - 1);
  std::size_t slot = 0;
  for (const int i : mechanism.movingLinks()) {
    const scene::JointKind kind = mechanism.links[i].joint.kind;
    slot += scene::positionSlots(kind).size();
    if (scene::ratesArePositionDerivatives(kind)) continue;
    long double squared = 0, along = 1;
    for (std::size_t k = slot - 4; k < slot; ++k) squared += out[k] * out[k];
    if (!like.empty()) {
      along = 0;
      for (std::size_t k = slot - 4; k < slot; ++k) along += out[k] * like[k];
    }
    const long double length = std::copysign(std::sqrt(squared), along);
    for (std::size_t k = slot - 4; k < slot; ++k) out[k] /= length;
  }
  return out;
}

/// Largest difference of the first entries [rad, m, rad/s, m/s]; NaN where one is.
template <typename T>
T largestGap(const std::vector<T>& a, const std::vector<T>& b, std::size_t count) {
  T worst = 0;
  for (std::size_t i = 0; i < count; ++i) keepWorse(&worst, std::abs(a[i] - b[i]));
  return worst;
}

/// Decimal digits that two answers share whose largest entry is `size` [rad, m, 1/s], up to
/// those of a double: of 1 + size, as steps that adapt count, for at rest only rounding is there.
inline int sharedDigits(double gap, double size) {
  constexpr int kOfDouble = 16;
  if (gap == 0) return kOfDouble;
  const double digits = std::floor(-std::log10(gap / (1 + size)));
  return std::isfinite(digits) ? std::clamp(static_cast<int>(digits), 0, kOfDouble) : 0;
}
/// "agree to 7 digits", "DISAGREE in the first digit"
inline std::string agreementText(int shared) {
  if (shared == 0) return "DISAGREE in the first digit";
  return fmt::format("agree to {} digit{}", shared, shared == 1 ? "" : "s");
}

}  // namespace dynwitness::crosscheck
