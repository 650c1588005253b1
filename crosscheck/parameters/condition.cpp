// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/parameters/condition.hpp"

#include <limits>

#include <Eigen/SVD>

namespace dynwitness::crosscheck {

std::optional<double> conditionOf(const Eigen::MatrixXd& W) {
  if (W.rows() < W.cols() || W.cols() == 0) return {};
  // Jacobi's method keeps small singular values better, and takes minutes from here on
  constexpr Eigen::Index kMostByJacobi = 200;
  const Eigen::VectorXd s = W.cols() <= kMostByJacobi
                                ? Eigen::JacobiSVD<Eigen::MatrixXd>(W).singularValues()
                                : Eigen::BDCSVD<Eigen::MatrixXd>(W).singularValues();
  const double condition = s(0) / s(s.size() - 1);
  if (!(condition * std::numeric_limits<double>::epsilon() * static_cast<double>(W.rows()) < 1))
    return {};
  return condition;
}

}  // namespace dynwitness::crosscheck
