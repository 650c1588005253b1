// SPDX-License-Identifier: GPL-3.0-or-later
// Guaranteed bounds of how far the joint accelerations of two models lie apart, and of one's.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/reduction/envelope.hpp"

namespace dynwitness::crosscheck {

/** Bounds of |e_i|, e = qdd_r - qdd of two models at the same q, qd and tau, over a box of these.

    With the forces s = tau - h, D = M_r - M and d = h_r - h (friction, springs and loads are those
    of both, so that tau is in neither),

        M qdd = s,   M_r e = -d - D qdd                                                      (1)

    Whatever vectors l and k are, by (1)

        e_i = -l'd + k's + (u_i - M_r l)'e - (D l + M k)'qdd,   u_i: row i of the unit matrix  (2)

    At the corners of a box in q, l is row i of M_r^-1 and k = (M_r^-1 - M^-1) u_i, so that both
    brackets are 0; between corners l and k are interpolated, linearly in each joint, and everything
    in (2) but e, qdd, tau and friction is a product of these and of polynomials: its second
    derivatives are known at corners, sign by sign, and between them by the fourth. So a bracket is
    of second order in the widths, entry by entry, and what it is multiplied by may be bounded
    generously. Of tau nothing else is lost: (2) is linear in it, and k has no second derivative.

    |qdd_j| is what the caller knows of it, |e_j| > 0 what is asked for: if the bounds of all i by
    (2), over boxes that cover the envelope, are at most the |e_j| that were put into them, these
    hold. At one state let row i of N be (M_r l_i)'. By (2) the rest 1 - N takes all |x_j| <= |e_j|
    to |x_i| <= P_i |e_i|, and P_i < 1, since C_i + P_i <= 1 with C_i > 0 the share of all else (it
    holds roundings at least). So N, and with it M_r, has an inverse, and e is finite. For
    E = max |e_i(q, qd, tau)| / |e_i| asked for, taken at i, then E <= C_i + E P_i, so that E <= 1.

    Of one model |qdd_i| is bounded in the same way, by

        qdd_i = k's + (u_i - M k)'qdd                                                        (3)

    with what is already known of qdd: no more is put in than what holds, so that each is a bound.
    @throws scene::InputError  more monomials than the table takes */
class AccelerationErrors {
 public:
  /// @param ranges         each with tau; they and the models must outlive this
  /// @param accelerations  |qdd_j| is at most this in the envelope
  AccelerationErrors(const TrigonometricModel& full, const TrigonometricModel& reduced,
                     const std::vector<scene::JointRanges>& ranges,
                     const std::vector<double>& accelerations);
  /// Of one model: of() bounds |qdd_i| by (3).
  AccelerationErrors(const TrigonometricModel& model,
                     const std::vector<scene::JointRanges>& ranges);
  ~AccelerationErrors();

  /** By (2) or (3), `sampled` is what was seen at a corner less its roundings.
      @param within  |e_j| that are asked for, or known, all > 0; by (3) what is known of |qdd_j|
      @param decide  as boundOfParts()
      @return by (2), `certified` is a bound if all i stay within `within`, and else none */
  EnvelopeBound of(int i, const std::vector<double>& within, const EnvelopeOptions& options,
                   double decide);
  /// The same where something is known of it: what comes back is no worse.
  EnvelopeBound better(const EnvelopeBound& before, const std::vector<double>& within,
                       const EnvelopeOptions& options, double decide);

 private:
  class Search;
  std::unique_ptr<Search> search_;
};

}  // namespace dynwitness::crosscheck
