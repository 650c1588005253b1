// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers with what they may be off by.
#pragma once

#include <Eigen/Core>

namespace dynwitness::crosscheck {

/// A matrix with the error bound of each entry.
struct Bounded {
  Eigen::MatrixXd value, bound;
};

}  // namespace dynwitness::crosscheck
