// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/estimated_number.hpp"

#include <cmath>
#include <limits>

#include <Eigen/QR>

namespace dynwitness::crosscheck::explaining {
namespace {

/// The shortest s of all with the least |A s - b|.
Eigen::VectorXd leastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

}  // namespace

std::optional<VectorXd> estimated(const Case& all, const std::vector<const Exhibit*>& exhibits,
                                  const Belief& base, const Suspect& suspect, VectorXd* uncertainty,
                                  bool quick) {
  const auto d = static_cast<Eigen::Index>(suspect.names.size());
  const auto with = [&](const VectorXd& added) {
    Belief belief = base;
    suspect.apply(belief, added);
    return belief;
  };
  const auto predicted = [&](const VectorXd& added) {
    return all.stacked(exhibits, with(added), true);
  };
  const VectorXd zero = VectorXd::Zero(d);
  const VectorXd D = all.stacked(exhibits, base, false);
  if (!D.allFinite()) return {};
  /// First and second derivative at a value, by differences.
  struct Slopes {
    MatrixXd b;
    VectorXd a;
  };
  const auto slopesAt = [&](const VectorXd& s, const VectorXd& f0) -> std::optional<Slopes> {
    Slopes out{MatrixXd(D.size(), d), VectorXd::Zero(D.size())};
    for (Eigen::Index k = 0; k < d; ++k) {
      const double h = suspect.scale[static_cast<std::size_t>(k)];
      VectorXd step = zero;
      step(k) = h;
      const VectorXd forward = predicted(s + step), backward = predicted(s - step);
      if (!forward.allFinite() || !backward.allFinite()) return {};
      out.b.col(k) = (forward - backward) / (2 * h);
      if (d == 1) out.a = (forward + backward - 2 * f0) / (2 * h * h);
    }
    return out;
  };
  const auto slopes = slopesAt(zero, all.stacked(exhibits, base, true));
  if (!slopes) return {};
  const VectorXd& a = slopes->a;
  MatrixXd slope = slopes->b;
  if (!(slope.cwiseAbs().maxCoeff() > 0) && !(a.cwiseAbs().maxCoeff() > 0)) return {};
  VectorXd s = zero;
  if (d > 1) {
    s = leastSquares(slope, D);
  } else {
    const VectorXd b1 = slope.col(0);
    std::vector<double> starts = {b1.squaredNorm() > 0 ? b1.dot(D) / b1.squaredNorm() : 0.0};
    Eigen::Index at = 0;
    D.cwiseAbs().maxCoeff(&at);
    const double square = b1(at) * b1(at) + 4 * a(at) * D(at);
    if (a(at) != 0 && square >= 0)
      for (const int sign : {-1, 1})
        starts.push_back((-b1(at) + sign * std::sqrt(square)) / (2 * a(at)));
    double best = std::numeric_limits<double>::infinity();
    constexpr int kPolish = 6;
    for (double x : starts) {
      for (int k = 0; k < kPolish; ++k) {
        const VectorXd slope_here = b1 + 2 * x * a;
        const double norm = slope_here.squaredNorm();
        if (norm > 0) x += slope_here.dot(D - x * b1 - x * x * a) / norm;
      }
      const double miss = (D - x * b1 - x * x * a).norm();
      if (miss < best) best = miss, s(0) = x;
    }
    slope = b1 + 2 * s(0) * a;
    // what is left has to be within the limits, and within what the differences lose of them
    const double steps = std::abs(s(0)) / suspect.scale[0];
    double growth = 1;
    for (const Exhibit* e : exhibits)
      if (largest(e->truth) > 0) growth = std::max(growth, largest(e->said) / largest(e->truth));
    const double left = (D - s(0) * b1 - s(0) * s(0) * a).cwiseAbs().maxCoeff();
    if (!(left <= 2 * growth * (1 + steps + 2 * steps * steps))) return {};
    if (quick) return s;
  }
  constexpr int kRefine = 2, kNewton = 8;  // one: from what the differences lost
  for (int k = 0; k < (suspect.is_linear || d == 1 ? kRefine : kNewton); ++k) {
    if (d > 1 && !suspect.is_linear) {
      const auto here = slopesAt(s, D);
      if (!here) return {};
      slope = here->b;
    }
    const VectorXd off = all.stacked(exhibits, with(s), false);
    if (!off.allFinite()) return {};
    s += leastSquares(slope, off);
  }
  // so far each may go alone before an entry leaves its limit
  *uncertainty = zero;
  for (Eigen::Index k = 0; k < d; ++k) {
    const double steepest = slope.col(k).cwiseAbs().maxCoeff();
    (*uncertainty)(k) = steepest > 0 ? 1 / steepest : std::numeric_limits<double>::infinity();
  }
  return s;
}

}  // namespace dynwitness::crosscheck::explaining
