// SPDX-License-Identifier: GPL-3.0-or-later
// What "agree" means: residuals against proven limits, collected over states.
#pragma once

#include <functional>
#include <string>

#include <Eigen/Core>

#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// What a limit may be in errors that are seen (CheckResult::limitOverSeen). Beyond that it is
/// none.
inline constexpr double kWidestLimit = 1e4;

/** Collects one check over its states. Every entry of left - right must lie within the limit of
    that entry; what is reported is the entry and state that use the largest part of their limit. */
class Tally {
 public:
  /// What an entry is called.
  using EntryName = std::function<std::string(Eigen::Index row, Eigen::Index column)>;
  /// @param name  none: entryName()
  explicit Tally(CheckResult description, EntryName name = {})
      : result_(std::move(description)), name_(std::move(name)) {}

  /** limit: entry by entry, same shape as left and right; an entry that is not finite says that no
      limit could be proven, and voids the state (its other entries may still disagree).
      @param excuse  why there is nothing to compare at this state, should it be voided; empty:
                      there is */
  void add(int state, const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
           const Eigen::MatrixXd& limit, const std::string& excuse = {});
  /// The same of a difference that is known already, counted in ulp of this largest magnitude.
  void addDifference(int state, const Eigen::MatrixXd& difference, const Eigen::MatrixXd& limit,
                     double largest, const std::string& excuse = {});
  /// The check could not be asked at this state.
  void fail(int state, const std::string& reason, const std::string& excuse = {});

  /// Keeps the largest condition of M met.
  void addCondition(double condition);

  CheckResult result() const;

 private:
  std::string nameOf(Eigen::Index row, Eigen::Index column, const Eigen::MatrixXd& shape) const;

  CheckResult result_;
  EntryName name_;
  double largest_there_ = 0;  ///< at the state of the largest share
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
