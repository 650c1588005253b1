// SPDX-License-Identifier: GPL-3.0-or-later
// When two sides in balls say enough: how their precision is chosen.
#pragma once

#include <algorithm>
#include <limits>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/scalars/ball.hpp"

namespace dynwitness::crosscheck {

/// Bits that are tried first, and where doubling ends.
inline constexpr long kFirstBits = 128, kMostBits = 2048;

/// Every difference is known to 2^-20 of an ulp of the larger side.
inline bool isNarrow(const TwoSides<Ball>& law) {
  constexpr double kNarrow = 0x1p-20 * std::numeric_limits<double>::epsilon();
  double largest = 0, radius = 0;
  for (Eigen::Index k = 0; k < law.left.size(); ++k) {
    const Ball difference = law.left.data()[k] - law.right.data()[k];
    if (!difference.isFinite()) return false;
    largest = std::max({largest, law.left.data()[k].atMost(), law.right.data()[k].atMost()});
    radius = std::max(radius, difference.radius());
  }
  return radius <= kNarrow * largest;
}

}  // namespace dynwitness::crosscheck
