// SPDX-License-Identifier: GPL-3.0-or-later
// A state whose numbers stand for all that round to them.
#pragma once

#include <cmath>
#include <vector>

#include "crosscheck/scalars/running_error.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// x, and that half a unit in its last place may have been lost when it was rounded to double.
inline RunningError rounded(double x) {
  return {x, RunningError::kUnitRoundoff * std::abs(x)};
}

/// The position q, rounded; cosine and sine follow by |dc|, |ds| <= |dq|.
inline scene::JointPosition<RunningError> roundedPosition(double q) {
  scene::JointPosition<RunningError> x = runningErrorPosition(q);
  const double moved = RunningError::kUnitRoundoff * std::abs(q);
  x.q = rounded(q);
  x.c = RunningError(x.c.value(), (x.c.bound() + moved) * RunningError::kInflate);
  x.s = RunningError(x.s.value(), (x.s.bound() + moved) * RunningError::kInflate);
  return x;
}

inline std::vector<RunningError> rounded(const std::vector<double>& values) {
  std::vector<RunningError> out;
  for (const double x : values) out.push_back(rounded(x));
  return out;
}

}  // namespace dynwitness::crosscheck
