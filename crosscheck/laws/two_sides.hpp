// SPDX-License-Identifier: GPL-3.0-or-later
// A law as two sides that must be equal.
#pragma once

#include <string>

#include <Eigen/Core>

namespace dynwitness::crosscheck {

/// An identity in words: how it is called and whose computations it takes.
struct IdentityInfo {
  const char* name;
  const char* statement;
  const char* quantity;
  const char* left;
  const char* right;
};

/// What must be equal, or why there is nothing to compare: then both sides are empty.
template <typename T>
struct TwoSides {
  Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic> left, right;
  std::string failure = {};
};

}  // namespace dynwitness::crosscheck
