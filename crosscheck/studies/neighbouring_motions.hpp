// SPDX-License-Identifier: GPL-3.0-or-later
// Motions that start beside one, by the steps on duals.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "crosscheck/studies/action_problem.hpp"

namespace dynwitness::crosscheck::hamilton {

/// Motions that start at the same place with another velocity, and the same motion a little later.
struct Neighbours {
  explicit Neighbours(const Problem& problem);
  void step(double h);
  /// A(t), column k: where the k-th neighbour is, seen from the motion, n x n.
  Eigen::MatrixXd places() const;
  /// dp, p = M qd, in coordinates; column k of the k-th neighbour.
  Eigen::MatrixXd momenta();

  const Problem& problem;
  Flow<D> flow;
  std::vector<PhasePoint<D>> now;  ///< n neighbours by velocity, then the motion a little later
};

}  // namespace dynwitness::crosscheck::hamilton
