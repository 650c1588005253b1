// SPDX-License-Identifier: GPL-3.0-or-later
// The verdict on energy along simulated motion.
#pragma once

#include "crosscheck/motion/drift.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/** The verdict on a drift: with a correct qdd an integrator of order p loses energy as step^p, so
    the observed order must come out above p - 1. A wrong qdd drifts by the same amount at every
    step, an order of 0. So do steps that are too long for a stiff motion: where the order does not
    show, steps that adapt decide whether qdd is to blame, and the statement or the reason says what
    both found.
    @param options  those of the drift */
CheckResult checkDrift(const PreparedScene& scene, const Drift& drift,
                       const DriftOptions& options = {});

}  // namespace dynwitness::crosscheck
