// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <Eigen/Core>

namespace dynwitness::crosscheck {

/// What must be equal, or why there is nothing to compare: then both sides are empty.
template <typename T>
struct TwoSides {
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> left, right;
  std::string failure = {};
};

}  // namespace dynwitness::crosscheck
