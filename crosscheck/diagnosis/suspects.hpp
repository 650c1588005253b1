// SPDX-License-Identifier: GPL-3.0-or-later
// Which numbers of a mechanism may be others in somebody's dynamics.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/diagnosis/textbook.hpp"

namespace dynwitness::crosscheck {

/// A number of the mechanism that may be another one.
struct Suspect {
  std::string rule;
  int link = -1;
  bool at_joint = false;
  std::string what, unit;          ///< "mass of link 'arm'", "kg"
  std::vector<std::string> names;  ///< of its parameters
  std::vector<double> scene;       ///< what the scene says they are
  std::vector<double> scale;       ///< sizes that steps are measured in
  std::function<void(Belief&, const Eigen::VectorXd& added)> apply;
  bool is_linear = true;  ///< where there are several: answers are linear in them
};
/// All that are tried on a mechanism, one number before several.
std::vector<Suspect> suspects(const TextbookModel& model);

}  // namespace dynwitness::crosscheck
