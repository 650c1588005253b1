// SPDX-License-Identifier: GPL-3.0-or-later
// Linearized motion of whole mechanisms: closures, springs between points, drives, acceleration
// constraints, bodies that turn while they move.
#pragma once

#include <memory>
#include <vector>

#include "crosscheck/studies/linearization.hpp"

namespace dynwitness::crosscheck {

/** Motion near a state on what closures leave free.

    With dq and dqd along all rates, of closure equations those that stand for all (rows h fail at
    positions, the others are of rates alone, scene::isOfRates), and every derivative by dual
    numbers through the dense system of the sweeps,

        (1)  J_h dq = 0                             dq  = T_q z
        (2)  J dqd + d(J qd)/dq dq = 0              dqd = T_v w + K z
        (3)  z' = S_q (dqd - [qd, dq])              [ , ]: commutator of body rates, else 0
        (4)  w' = S_v (dqdd/dq dq + dqdd/dqd dqd)   qdd of the constrained mechanism

    z are the dq and w the dqd that S_q and S_v pick out, and on which the others depend: pivots in
    double say which, the elimination is in balls. Driven joints are at t = 0 and do not deviate;
    acceleration constraints are part of qdd and take no coordinate.
    @see R. Kane, D. Levinson, Dynamics (1985), 5.3; J. P. Meijaard et al., Proc. R. Soc. A 463
      (2007), appendix */
class ConstrainedLinearization {
 public:
  /// Whether it takes this to linearize the mechanism.
  static bool isNeeded(const scene::Mechanism& mechanism, const std::vector<double>& qd);

  explicit ConstrainedLinearization(const scene::Scene& scene);
  ~ConstrainedLinearization();

  /** Driven joints go to where they are at t = 0, q and qd the shortest way onto closures.
      @throws scene::InputError  no small change closes them, or no joint is free */
  void close(std::vector<double>* q, std::vector<double>* qd);
  /** Newton's steps in z from a guess until the free joints rest without forces, qd of the free 0.
      @throws scene::InputError  none is found
      @return how many */
  int seekEquilibrium(std::vector<double>* q, std::vector<double>* qd);
  /// Fills in what motion near out.q, out.qd is, at the precision of the moment; tau as options
  /// say: none, or the shortest with which no independent rate accelerates.
  void differentiate(const LinearizationOptions& options, Linearization* out);
  /** dqdd, d(J qd) and J dq of sweeps and of Lagrange's equations with multipliers, along one
      direction of positions, rates and forces together, its entries drawn: one wrong entry of any
      derivative shows in it. */
  CheckResult compared();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
