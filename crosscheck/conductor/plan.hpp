// SPDX-License-Identifier: GPL-3.0-or-later
// What a crosscheck of a large scene leaves out, so that it ends. All of it is told: on the
// terminal, in the report.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/verdicts/options.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** One state of n joints costs O(n^2), as many as M has entries, and of n links as well, whose
    reactions are bounded one by one; laws with dM/dt, exact checks and equations that are derived
    O(n^3) and more. Joints are counted but for the states, where fixed links count too.

        n <= 64     everything, at the states that were asked for
        n <= 128    where no number of states was asked for: as many as cost what the usual number
                    does with 64 joints, but two at least
        n <= 1000   neither laws, nor exact checks, nor equations, nor simulated energy */
struct Plan {
  int states;
  bool whole = true;              ///< laws, exact checks, equations, energy too
  std::vector<std::string> told;  ///< what is left out, and why; empty: nothing
};

/// @throws scene::InputError  more than 1000 joints: one matrix of balls is 150 MB then
Plan planFor(const scene::Scene& scene, const Options& options);

/** About how long one processor takes for the crosscheck of a scene [s]: states cost n^2 each,
    exact checks up to n^3. The factors were measured with all witnesses, on scenes of 2 to 31
    joints at 10 and 100 states (within a factor of two); fewer witnesses take less. */
double expectedSeconds(const scene::Scene& scene, const Plan& plan);

}  // namespace dynwitness::crosscheck
