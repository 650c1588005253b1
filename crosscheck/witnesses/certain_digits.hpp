// SPDX-License-Identifier: GPL-3.0-or-later
// How many digits of an answer its own bound vouches for.
#pragma once

#include <cmath>
#include <limits>

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// Whoever has fewer of them has no answer to act upon, and has to say so.
inline constexpr int kFewestDigits = 3;

/// -log10(the largest bound / the largest entry): decimal digits, as a share of the largest entry,
/// that the rounding of this sweep leaves at the least. 0 or less: none; infinite: nothing was
/// rounded.
inline double certainDigits(const Answer& answer) {
  if (answer.value.size() == 0) return std::numeric_limits<double>::infinity();
  const double bound = answer.bound.maxCoeff(), largest = answer.value.cwiseAbs().maxCoeff();
  if (!answer.value.allFinite() || !answer.bound.allFinite()) return 0;
  if (bound == 0) return std::numeric_limits<double>::infinity();
  return largest == 0 ? 0 : -std::log10(bound / largest);
}

}  // namespace dynwitness::crosscheck
