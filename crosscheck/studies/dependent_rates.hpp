// SPDX-License-Identifier: GPL-3.0-or-later
// How the rates of a closed mechanism follow from the independent ones.
#pragma once

#include <Eigen/Core>

#include "crosscheck/studies/action_problem.hpp"

namespace dynwitness::crosscheck::hamilton {

/// At a position of the motion.
struct Dependence {
  Dependence(const Problem& problem, const Values& slots);
  int dof;
  double regularity;               ///< smallest pivot over the largest singular value, det's sign
  Eigen::MatrixXd inverse, along;  ///< of J of the dependent rates; all rates, dof x n
};

}  // namespace dynwitness::crosscheck::hamilton
