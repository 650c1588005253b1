// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/second_variation.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "crosscheck/studies/near_motion.hpp"

namespace dynwitness::crosscheck::hamilton {

std::vector<Eigen::MatrixXd> hessians(const Problem& problem, const std::vector<Node>& nodes) {
  const int n = problem.n();
  Near<DD> near(problem);
  std::vector<Eigen::MatrixXd> out;
  for (const Node& node : nodes) {
    Eigen::MatrixXd H(2 * n, 2 * n);
    for (int a = 0; a < 2 * n; ++a)
      for (int b = 0; b <= a; ++b) {
        std::vector<DD> z[2] = {std::vector<DD>(n, DD(D(0.0))), std::vector<DD>(n, DD(D(0.0)))};
        z[a / n][a % n] += DD(D(0.0, 1.0));
        z[b / n][b % n] += DD(D(0.0), D(1.0));
        near.at(node, z[0], z[1]);
        H(a, b) = H(b, a) = near.lagrangian().derivative.derivative;
      }
    out.push_back(H);
  }
  return out;
}

std::vector<Element> elements(const Problem& problem, const std::vector<Eigen::MatrixXd>& H,
                              int stride, double least) {
  const int n = problem.n(), last = static_cast<int>(H.size()) - 1;
  const double width = 2 * stride * problem.duration / last;
  std::vector<Element> out;
  for (int k = 0; k < last; k += 2 * stride) {
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(n, n), right = left, across = left;
    for (int point = 0; point < 3; ++point) {
      const Eigen::MatrixXd& h = H[k + point * stride];
      const Eigen::MatrixXd qq = h.topLeftCorner(n, n), qv = h.topRightCorner(n, n),
                            vv = (1 - least) * h.bottomRightCorner(n, n);
      const double weight = (point == 1 ? 4 : 1) * width / 6, up = point / 2.0, down = 1 - up,
                   slope = 1 / width;
      left +=
          weight * (down * down * qq - down * slope * (qv + qv.transpose()) + slope * slope * vv);
      right += weight * (up * up * qq + up * slope * (qv + qv.transpose()) + slope * slope * vv);
      across += weight * (down * up * qq + down * slope * qv - up * slope * qv.transpose() -
                          slope * slope * vv);
    }
    out.push_back({left, right, across});
  }
  return out;
}

int negativeDirections(const Problem& problem, const std::vector<Eigen::MatrixXd>& H, int stride,
                       double least) {
  int negative = 0;
  Eigen::MatrixXd carried;  // of the elements to the left
  for (const Element& element : elements(problem, H, stride, least)) {
    Eigen::MatrixXd right = element.right;
    if (carried.size() > 0) {  // the node between this element and the last is free
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> D(carried + element.left);
      negative += static_cast<int>((D.eigenvalues().array() < 0).count());
      right -= element.across.transpose() * D.eigenvectors() *
               D.eigenvalues().cwiseInverse().asDiagonal() * D.eigenvectors().transpose() *
               element.across;
    }
    carried = right;
  }
  return negative;
}

double eigenvalue(const Problem& problem, const std::vector<Eigen::MatrixXd>& H, int number) {
  const auto isBelow = [&](double value) {
    return negativeDirections(problem, H, 1, value) >= number;
  };
  double low = -1, high = 1;
  while (isBelow(low) && std::isfinite(low)) low *= 2;
  for (double middle = 0; middle > low && middle < high; middle = low + (high - low) / 2)
    (isBelow(middle) ? high : low) = middle;
  return high;
}

}  // namespace dynwitness::crosscheck::hamilton
