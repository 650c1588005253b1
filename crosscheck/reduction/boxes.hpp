// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes in q and qd that are halved until what is asked about them is known.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/scalars/running_error.hpp"
#include "scene/envelope.hpp"

namespace dynwitness::crosscheck {

/// Sums over the monomials of a quantity have fewer terms than this, each with fewer than 2^6
/// roundings of u = 2^-53: what is lost is below kLost of the sum of the magnitudes.
inline constexpr std::size_t kMostMonomials = std::size_t{1} << 16;
inline constexpr double kLost = RunningError::kUnitRoundoff * kMostMonomials * 64;

/// No less than the magnitude of what the number stands for.
inline double most(const RunningError& x) {
  return (std::abs(x.value()) + x.bound()) * (1 + kLost);
}

struct Box {
  std::vector<scene::Range> q, qd;  ///< of those joints and rates that what is bounded depends on
  double bound = 0;
  int split = -1;  ///< which of q, then qd adds most to the bound; -1: none adds anything
};

inline double half(const scene::Range& r) {
  return 0.5 * (r.high - r.low);
}

struct BoxesSeen {
  double bound;  ///< the largest of all boxes'
  int count;     ///< judged
};
/** Halves the box with the largest bound, across the variable that adds most, until isKnown(bound)
    or the budget of boxes is spent.
    @param judge  sets bound and split of a box */
BoxesSeen bestFirst(Box whole, int boxes, const std::function<void(Box*)>& judge,
                    const std::function<bool(double)>& isKnown);

/** The largest of sign (sum_{b<=a} form(a, b) qd_a qd_b + linear'qd) over the corners of a box.
    @param form  lower triangle
    @param worst  the corner */
double largestAtRates(const Eigen::MatrixXd& form, const Eigen::VectorXd& linear,
                      const std::vector<scene::Range>& qd, int sign, std::vector<double>* worst);

/// The largest of sign f over a range of qd, f being `forward` where qd > 0, -backward where qd < 0
/// and 0 at rest.
double largestDryFriction(const scene::Range& qd, double forward, double backward, int sign);

}  // namespace dynwitness::crosscheck
