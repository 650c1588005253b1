// SPDX-License-Identifier: GPL-3.0-or-later
// What is said of the action: directions that lower it, paths near by.
#pragma once

#include <vector>

#include "crosscheck/studies/action_problem.hpp"
#include "crosscheck/studies/lowest_direction.hpp"

namespace dynwitness::crosscheck::hamilton {

/// A check of one motion whose words these are.
CheckResult describe(const char* name, const char* statement, const char* quantity,
                     const char* left);

/** The second variation: how many directions lower the action. Where that and conjugate times
    differ, one eigenvalue has the wrong sign. It is wrong only if it is farther from 0 than steps
    of twice the length move it.
    @param sharp  conjugate times are the same at two sizes of steps */
void countDirections(const Problem& problem, const std::vector<Node>& nodes, bool sharp,
                     Action* out, Lines* slowest);

/// Whether S of the paths near by is larger or smaller, as far as it is sure.
void judgePaths(const std::vector<Action::Path>& paths, int negative, CheckResult* nearby);

/** Nothing is said where the steps round the place by as much as varied paths are away from it: at
    1e16 rad a pendulum moves by 2 rad or not at all. */
void judgePlaces(const std::vector<Node>& nodes, Action* out);

}  // namespace dynwitness::crosscheck::hamilton
