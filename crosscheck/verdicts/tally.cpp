// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/tally.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace dynwitness::crosscheck {
namespace {

/// The part of its limit that a residual uses; infinite when it is not a number or has no room.
double share(double residual, double limit) {
  if (residual == 0) return 0;
  if (!std::isfinite(residual) || limit == 0) return std::numeric_limits<double>::infinity();
  return residual / limit;
}

}  // namespace

std::string entryName(const std::string& quantity, Eigen::Index row, Eigen::Index column,
                      Eigen::Index rows, Eigen::Index columns) {
  if (rows * columns == 1) return quantity;
  if (columns == 1) return fmt::format("{}[{}]", quantity, row + 1);
  return fmt::format("{}[{},{}]", quantity, row + 1, column + 1);
}

std::string Tally::nameOf(Eigen::Index row, Eigen::Index column,
                          const Eigen::MatrixXd& shape) const {
  return name_ ? name_(row, column) : entryName(result_.quantity, row, column, shape);
}

void Tally::add(int state, const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
                const Eigen::MatrixXd& limit, const std::string& excuse) {
  if (left.rows() != right.rows() || left.cols() != right.cols()) {
    result_.verdict = Verdict::kDisagree;
    result_.reason = fmt::format("shapes differ: {} x {} and {} x {}", left.rows(), left.cols(),
                                 right.rows(), right.cols());
    ++result_.states;
    return;
  }
  const double largest = std::max(left.cwiseAbs().maxCoeff(), right.cwiseAbs().maxCoeff());
  addDifference(state, left - right, limit, std::isfinite(largest) ? largest : 0.0, excuse);
}

void Tally::addDifference(int state, const Eigen::MatrixXd& difference,
                          const Eigen::MatrixXd& limit, double largest, const std::string& excuse) {
  ++result_.states;
  result_.largest = std::max(result_.largest, largest);
  // what is 0 in balls is as small as their precision, and its ulp no double
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  const double unit = std::isnormal(kEpsilon * largest) ? largest : 0.0;
  const double ulp = kEpsilon * (unit > 0 ? unit : 1.0);
  std::string unbounded;  // the first entry without a limit
  for (Eigen::Index j = 0; j < difference.cols(); ++j) {
    for (Eigen::Index i = 0; i < difference.rows(); ++i) {
      const double residual = std::abs(difference(i, j));
      if (!std::isfinite(limit(i, j))) {
        if (unbounded.empty()) unbounded = nameOf(i, j, difference);
        continue;
      }
      result_.seen = std::max(result_.seen, residual);
      result_.loosest = std::max(result_.loosest, limit(i, j));
      const double used = share(residual, limit(i, j));
      if (result_.worst_entry.empty() || used > result_.ratio) {
        result_.ratio = used;
        largest_there_ = unit;
        result_.worst = residual / ulp;
        result_.limit = limit(i, j) / ulp;
        result_.worst_state = state;
        result_.worst_entry = nameOf(i, j, difference);
      }
    }
  }
  if (unbounded.empty()) return;
  const std::string reason = fmt::format(
      "no error bound for {} at state {}: a divisor is zero within rounding", unbounded, state);
  result_.addVoided(state, excuse.empty() ? reason : excuse, !excuse.empty());
}

void Tally::addCondition(double condition) {
  result_.condition = std::max(result_.condition.value_or(0), condition);
}

void Tally::fail(int state, const std::string& reason, const std::string& excuse) {
  ++result_.states;
  result_.addVoided(state, excuse.empty() ? fmt::format("state {}: {}", state, reason) : excuse,
                    !excuse.empty());
}

CheckResult Tally::result() const {
  CheckResult out = result_;
  if (!out.worst_entry.empty()) out.useItsOwnUnit(largest_there_);
  if (!(out.ratio <= 1)) {
    out.verdict = Verdict::kDisagree;
    out.reason =
        fmt::format("{} differs by {:.3g} {} at state {}, limit {:.3g} {}", out.worst_entry,
                    out.worst, out.unitName(), out.worst_state, out.limit, out.unitName());
  } else if (out.verdict == Verdict::kAgree && out.judged() == 0) {
    out.verdict = Verdict::kNotAnswerable;
    out.reason = out.states > 0 ? out.voided_reason : "asked at no state";
  }
  return out;
}

}  // namespace dynwitness::crosscheck
