// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/tally.hpp"

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

void Tally::add(int state, const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
                const Eigen::MatrixXd& limit) {
  ++result_.states;
  if (left.rows() != right.rows() || left.cols() != right.cols()) {
    result_.verdict = Verdict::kDisagree;
    result_.reason = fmt::format("shapes differ: {} x {} and {} x {}", left.rows(), left.cols(),
                                 right.rows(), right.cols());
    return;
  }
  const double scale = std::max(left.cwiseAbs().maxCoeff(), right.cwiseAbs().maxCoeff());
  const double ulp = std::numeric_limits<double>::epsilon() *
                     (scale > 0 && std::isfinite(scale) ? scale : 1.0);
  for (Eigen::Index j = 0; j < left.cols(); ++j) {
    for (Eigen::Index i = 0; i < left.rows(); ++i) {
      const double residual = std::abs(left(i, j) - right(i, j));
      if (!std::isfinite(limit(i, j))) {
        unanswered_ = fmt::format("no error bound for {} at state {}: a divisor is zero within rounding",
                                  entryName(result_.quantity, i, j, left), state);
        continue;
      }
      const double used = share(residual, limit(i, j));
      if (result_.worst_entry.empty() || used > result_.ratio) {
        result_.ratio = used;
        result_.worst = residual / ulp;
        result_.limit = limit(i, j) / ulp;
        result_.worst_state = state;
        result_.worst_entry = entryName(result_.quantity, i, j, left);
      }
    }
  }
}

void Tally::fail(int state, const std::string& reason) {
  ++result_.states;
  unanswered_ = fmt::format("state {}: {}", state, reason);
}

CheckResult Tally::result() const {
  CheckResult out = result_;
  if (!(out.ratio <= 1)) {
    out.verdict = Verdict::kDisagree;
    out.reason = fmt::format("{} differs by {:.3g} ulp at state {}, limit {:.3g} ulp",
                             out.worst_entry, out.worst, out.worst_state, out.limit);
  } else if (out.verdict == Verdict::kAgree && !unanswered_.empty()) {
    out.verdict = Verdict::kNotAnswerable;
    out.reason = unanswered_;
  }
  return out;
}

}  // namespace dynwitness::crosscheck
