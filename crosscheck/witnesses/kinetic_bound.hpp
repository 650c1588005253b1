// SPDX-License-Identifier: GPL-3.0-or-later
// What an outside program may lose of T where it finds it from M.
#pragma once

#include <limits>

#include <Eigen/Core>

namespace dynwitness::crosscheck {

/** Of T = qd' M qd / 2: what the errors of M and of the sum (4 n roundings) make of it.
    @param M  its magnitudes are enough */
inline Eigen::MatrixXd kineticBoundByMassMatrix(const Eigen::MatrixXd& M,
                                                const Eigen::MatrixXd& bound_of_M,
                                                const Eigen::VectorXd& qd) {
  const double u = std::numeric_limits<double>::epsilon() / 2;
  const Eigen::VectorXd rate = qd.cwiseAbs();
  return rate.transpose() * (bound_of_M + 4 * u * static_cast<double>(qd.size()) * M.cwiseAbs()) *
         rate / 2;
}

}  // namespace dynwitness::crosscheck
