// SPDX-License-Identifier: GPL-3.0-or-later
// A state whose numbers are what they are.
#pragma once

#include "crosscheck/scalars/running_error.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// A state of doubles as exact input with the C library's error in cos and sin.
inline scene::State<RunningError> runningErrorState(const scene::State<double>& state) {
  scene::State<RunningError> out;
  for (const scene::JointPosition<double>& x : state.x) out.x.push_back(runningErrorPosition(x.q));
  out.qd.assign(state.qd.begin(), state.qd.end());
  out.qdd.assign(state.qdd.begin(), state.qdd.end());
  out.tau.assign(state.tau.begin(), state.tau.end());
  return out;
}

}  // namespace dynwitness::crosscheck
