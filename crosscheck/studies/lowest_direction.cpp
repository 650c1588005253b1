// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/lowest_direction.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <boost/math/constants/constants.hpp>

#include "crosscheck/studies/second_variation.hpp"

namespace dynwitness::crosscheck::hamilton {

namespace {

constexpr double kPi = boost::math::constants::pi<double>();

}  // namespace

Lines lowestDirection(const Problem& problem, const std::vector<Eigen::MatrixXd>& H,
                      double lowest) {
  constexpr int kIterations = 8;
  constexpr double kBelow = 1e-6;  // each iteration leaves so much of the others, or less
  const int n = problem.n();
  const double least = lowest - kBelow * std::max(1.0, std::abs(lowest));
  const std::vector<Element> shifted = elements(problem, H, 1, least);
  const std::size_t inner = shifted.size() - 1;  // nodes that are free
  std::vector<Eigen::LLT<Eigen::MatrixXd>> D;
  for (std::size_t k = 0; k < inner; ++k) {
    Eigen::MatrixXd block = shifted[k].right + shifted[k + 1].left;
    if (k > 0) block -= shifted[k].across.transpose() * D.back().solve(shifted[k].across);
    D.emplace_back(block);
  }
  std::vector<Eigen::VectorXd> x(inner + 2, Eigen::VectorXd::Zero(n));
  for (std::size_t k = 0; k < inner; ++k)  // any that is no eigenvector of something simple
    for (int i = 0; i < n; ++i)
      x[k + 1](i) = std::sin(kPi * static_cast<double>(k + 1) / static_cast<double>(inner + 1)) *
                    (1 + 0.1 * i + 0.3 * static_cast<double>(k) / static_cast<double>(inner));
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    // the kinetic part of x, but for a factor
    std::vector<Eigen::VectorXd> b(inner + 2, Eigen::VectorXd::Zero(n));
    for (std::size_t k = 0; k <= inner; ++k) {
      const double width = 1 / static_cast<double>(inner + 1);
      Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
      for (int point = 0; point < 3; ++point)
        mass += (point == 1 ? 4 : 1) *
                H[2 * k + static_cast<std::size_t>(point)].bottomRightCorner(n, n);
      const Eigen::VectorXd stretch = mass * (x[k + 1] - x[k]) / width;
      b[k] -= stretch;
      b[k + 1] += stretch;
    }
    for (std::size_t k = 1; k < inner; ++k)
      b[k + 1] -= shifted[k].across.transpose() * D[k - 1].solve(b[k]);
    for (std::size_t k = inner; k-- > 0;) {
      Eigen::VectorXd right = b[k + 1];
      if (k + 1 < inner) right -= shifted[k + 1].across * x[k + 2];
      x[k + 1] = D[k].solve(right);
    }
    double largest = 0;
    for (const Eigen::VectorXd& v : x) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    for (Eigen::VectorXd& v : x) v /= largest;
  }
  return {x};
}

}  // namespace dynwitness::crosscheck::hamilton
