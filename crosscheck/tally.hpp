// SPDX-License-Identifier: GPL-3.0-or-later
// What "agree" means: residuals against proven limits, collected over states.
#pragma once

#include <string>

#include <Eigen/Core>

#include "crosscheck/result.hpp"

namespace dynwitness::crosscheck {

/** Collects one check over its states. Every entry of left - right must lie within the limit of that
    entry; what is reported is the entry and state that use the largest part of their limit. */
class Tally {
 public:
  explicit Tally(CheckResult description) : result_(std::move(description)) {}

  /// limit: entry by entry, same shape as left and right; an entry that is not finite says that no
  /// limit could be proven, and makes the check not answerable unless another state disagrees.
  void add(int state, const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
           const Eigen::MatrixXd& limit);
  /// The check could not be asked at this state.
  void fail(int state, const std::string& reason);

  CheckResult result() const;

 private:
  CheckResult result_;
  std::string unanswered_;
};

/// "M[1,2]", or "M" for a single number.
std::string entryName(const std::string& quantity, Eigen::Index row, Eigen::Index column,
                      Eigen::Index rows, Eigen::Index columns);
template <typename Derived>
std::string entryName(const std::string& quantity, Eigen::Index row, Eigen::Index column,
                      const Eigen::EigenBase<Derived>& shape) {
  return entryName(quantity, row, column, shape.rows(), shape.cols());
}

}  // namespace dynwitness::crosscheck
