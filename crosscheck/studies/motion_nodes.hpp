// SPDX-License-Identifier: GPL-3.0-or-later
// A motion in equal steps, and where it cannot be followed.
#pragma once

#include <vector>

#include "crosscheck/studies/action_problem.hpp"

namespace dynwitness::crosscheck::hamilton {

/// The motion at the ends of all steps, with Simpson's weights.
/// @throws scene::InputError  the independent rates at the start do not tell the others all along
std::vector<Node> motionOf(const Problem& problem, int steps);

/// How far T + V is from its value at the start, at most [J].
double energyDrift(const Problem& problem, const std::vector<Node>& nodes);

/// @throws scene::InputError  qdd is not finite at the start
void requireMotionAtStart(const Problem& problem);
/// The two finest sizes of steps are needed, and one of them left the numbers.
/// @throws scene::InputError  always: when, and a duration that these steps end
[[noreturn]] void refuseUnresolved(const Problem& problem);

}  // namespace dynwitness::crosscheck::hamilton
