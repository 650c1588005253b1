// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/meeting.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

namespace dynwitness::crosscheck::hamilton {

Action::Conjugate manyMeet(Neighbours* neighbours, const std::vector<PhasePoint<D>>& from,
                           double start, double h) {
  const auto values = [&](double later) {
    neighbours->now = from;
    neighbours->step(later);
    return Eigen::VectorXd(
        Eigen::JacobiSVD<Eigen::MatrixXd>(neighbours->places()).singularValues().reverse());
  };
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double low = 0, high = 2 * h;
  while (high - low > h / kSharp) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (values(a)(0) < values(b)(0) ? high : low) = values(a)(0) < values(b)(0) ? b : a;
  }
  const double at = (low + high) / 2;
  const Eigen::VectorXd least = values(at), before = values(0), after = values(2 * h);
  Action::Conjugate out = {start + at, 0, 0};
  for (Eigen::Index i = 0; i < least.size(); ++i) {
    const double slope =
        std::max((before(i) - least(i)) / at, (after(i) - least(i)) / (2 * h - at));
    if (slope > 0 && least(i) / slope < neighbours->problem.duration / kSharp) ++out.multiplicity;
  }
  return out;
}

}  // namespace dynwitness::crosscheck::hamilton
