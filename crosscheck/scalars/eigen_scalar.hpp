// SPDX-License-Identifier: GPL-3.0-or-later
// What Eigen must be told about a scalar of ours.
#pragma once

#include <Eigen/Core>

namespace dynwitness::crosscheck {

/** Base of Eigen::NumTraits<T> for a real scalar that is no plain double: one that needs its
    constructor, and stays what it is in every expression. The costs (an addition of doubles is 1)
    only tell Eigen when to store an intermediate result. */
template <typename T, int kReadCost, int kAddCost, int kMultiplyCost>
struct EigenScalar : Eigen::GenericNumTraits<double> {
  using Real = T;
  using NonInteger = T;
  using Nested = T;
  using Literal = T;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = kReadCost,
    AddCost = kAddCost,
    MulCost = kMultiplyCost
  };
};

}  // namespace dynwitness::crosscheck
