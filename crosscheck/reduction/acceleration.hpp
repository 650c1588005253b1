// SPDX-License-Identifier: GPL-3.0-or-later
// Guaranteed bounds of joint accelerations over ranges of q, qd and tau.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/reduction/envelope.hpp"

namespace dynwitness::crosscheck {

/** Bounds of |qdd_i|, qdd = M^-1 (tau - c - g - friction), over a box of q, qd and tau.

    As envelopeBounds(): the largest at the corners, exact in tau, and in qd but for squares that
    are concave; between corners in q it may rise by w_k^2 / 2 sup |d^2 qdd_i / dq_k^2|. With
    M y = s, one s for each column of tau, for g and for each product of rates,

        y'' = M^-1 (s'' - 2 M' y' - M'' y),   y' = M^-1 (s' - M' y)                        (1)

    and in the norm |s|^2 = s' M^-1 s, mu = |M'| and nu = |M''| being relative to M,

        |y_i''| <= sqrt((M^-1)_ii) (|s''| + 2 mu (|s'| + mu |s|) + nu |s|)                 (2)

    Each of these is bounded all over the box by the corners: inside, M is a mean of the corners' M
    and a rest R, of second order in w. s' M^-1 s is convex in s and M together, and -mu M <= M' <=
    mu M is linear, so that means are no worse than the worst corner; and |R| <= rho M, rho =
    sum |R_jk| sqrt((M^-1)_jj (M^-1)_kk) < 1, takes M to no less than (1 - rho) times the mean (3).
    Where rho is 1 or more a box has no bound and is halved. What a few boxes say of all joints is
    then sharpened entry by entry (AccelerationErrors); joints share corners, and what is known of
    one sharpens the others. Roundings are counted as everywhere here; M is factored in
    RunningError. */
class AccelerationBounds {
 public:
  /// @param ranges  each with tau; they and the model must outlive this
  AccelerationBounds(const TrigonometricModel& model,
                     const std::vector<scene::JointRanges>& ranges);
  ~AccelerationBounds();

  /// Of |qdd_i|, as BoundedQuantity::over(), `sampled` being |qdd_i| at `worst` less its roundings;
  /// `certified` is infinite where the budget ended before (3).
  EnvelopeBound over(int i, const std::vector<scene::JointRanges>& box,
                     const EnvelopeOptions& options, double decide);

 private:
  class Searches;
  std::unique_ptr<Searches> searches_;
};

}  // namespace dynwitness::crosscheck
