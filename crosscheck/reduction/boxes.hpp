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

/// The corners of a box in q, an edge of no length having one end, until one is refused.
/// @param visit  visit(ends, q), in bit k of `ends` whether q_k is the upper one. @return to go on
/// @return whether all were visited
template <typename Visit>
bool forCorners(const Box& box, const Visit& visit) {
  std::vector<double> q(box.q.size());
  for (std::size_t ends = 0; ends < std::size_t{1} << q.size(); ++ends) {
    bool again = false;
    for (std::size_t k = 0; k < q.size(); ++k) {
      const bool upper = (ends >> k & 1) != 0;
      q[k] = upper ? box.q[k].high : box.q[k].low;
      again = again || (upper && box.q[k].high == box.q[k].low);
    }
    if (!again && !visit(ends, q)) return false;
  }
  return true;
}

struct BoxesSeen {
  double bound;  ///< the largest of all boxes'
  int count;     ///< judged
};
/** Halves the box with the largest bound, across the variable that adds most, until isKnown(bound)
    or the budget of boxes is spent.
    @param judge  sets bound and split of a box
    @param look   now and then, the more boxes the more seldom: looks for what is larger than all
      that was seen at corners */
BoxesSeen bestFirst(Box whole, int boxes, const std::function<void(Box*)>& judge,
                    const std::function<bool(double)>& isKnown, const std::function<void()>& look);

/** What is seen of a function of q beside the corners of boxes, which are few in many dimensions:
    from the largest corner since it last climbed one coordinate after the other is moved as long as
    that makes it larger, by a quarter of its range first and 2^-10 of it in the end. */
class Climb {
 public:
  void start() { *this = {}; }
  void saw(double value, const std::vector<double>& q);
  /// @param at  the function; as it must not leave what is bounded, q stays in these ranges
  void from(const std::vector<scene::Range>& ranges,
            const std::function<double(const std::vector<double>&)>& at);

 private:
  double value_ = -HUGE_VAL;
  std::vector<double> q_;
};

/** The largest of sign (sum_{b<=a} form(a, b) qd_a qd_b + linear'qd) over the corners of a box.
    @param form  lower triangle
    @param worst  the corner */
double largestAtRates(const Eigen::MatrixXd& form, const Eigen::VectorXd& linear,
                      const std::vector<scene::Range>& qd, int sign, std::vector<double>* worst);

/// The largest of sign f over a range of qd, f being `forward` where qd > 0, -backward where qd < 0
/// and 0 at rest.
double largestDryFriction(const scene::Range& qd, double forward, double backward, int sign);

}  // namespace dynwitness::crosscheck
