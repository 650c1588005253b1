// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/independent_rates.hpp"

#include <algorithm>
#include <iterator>

#include <Eigen/QR>

namespace dynwitness::crosscheck {

Indices pivots(const Eigen::MatrixXd& J, const Indices& columns) {
  Indices out;
  if (J.rows() == 0) return out;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J);
  for (Eigen::Index k = 0; k < J.rows(); ++k)
    out.push_back(columns[static_cast<std::size_t>(qr.colsPermutation().indices()(k))]);
  std::sort(out.begin(), out.end());
  return out;
}

Indices without(const Indices& all, const Indices& some) {
  Indices out;
  std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(out));
  return out;
}

Eigen::MatrixXd solvedByColumns(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return A.colPivHouseholderQr().solve(B);
}

}  // namespace dynwitness::crosscheck
