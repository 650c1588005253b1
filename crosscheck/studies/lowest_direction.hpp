// SPDX-License-Identifier: GPL-3.0-or-later
// The direction that lowers the action most.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "crosscheck/studies/action_problem.hpp"

namespace dynwitness::crosscheck::hamilton {

/// A variation that is straight from node to node, 0 at both ends, nowhere above 1.
struct Lines {
  std::vector<Eigen::VectorXd> at;  ///< at the ends of equal parts of the duration
  int parts() const { return static_cast<int>(at.size()) - 1; }
};

/** The direction of the second variation's lowest eigenvalue, by inverse iteration just below it,
    where the second variation less that much of its kinetic part is positive definite: L L' block
    by block.
    @param lowest  of eigenvalue() */
Lines lowestDirection(const Problem& problem, const std::vector<Eigen::MatrixXd>& H, double lowest);

}  // namespace dynwitness::crosscheck::hamilton
