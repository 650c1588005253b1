// SPDX-License-Identifier: GPL-3.0-or-later
// The action of paths beside the motion, with the same ends.
#pragma once

#include <vector>

#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/studies/first_variation.hpp"
#include "crosscheck/studies/lowest_direction.hpp"

namespace dynwitness::crosscheck::hamilton {

/// S of the path q + amplitude zeta, by the nodes and by every second of them.
struct PathAction {
  RunningError by_all = 0, by_half = 0;
};

/// @param zeta  null: the motion's own
PathAction actionOf(const Problem& problem, const std::vector<Node>& nodes, const Sines* zeta,
                    double amplitude);

/** S(q + eta) - S(q), and what of it is not the second variation's:
      roundings             running error bounds, of q + eta too
      the steps             the integral by every second node differs by more than by all
      dS                    which would vanish if the steps followed the motion
      higher variations     those of even eta^4 and odd eta^3 leave 3/4 and 1/2 of themselves in
                            change(eta) - 4 change(eta / 2), hence twice that */
Action::Path::Change changeOf(const Problem& problem, const std::vector<Node>& nodes,
                              const PathAction& own, const Sines& zeta, double first,
                              double amplitude);

/** S(q + eta) - S(q) as changeOf() has it; what steps leave of it is by how much half as many
    change it. */
Action::Path::Change changeAlong(const Problem& problem, const std::vector<Node>& nodes,
                                 const std::vector<Node>& coarse, const Lines& eta,
                                 double amplitude, double* first);

}  // namespace dynwitness::crosscheck::hamilton
