// SPDX-License-Identifier: GPL-3.0-or-later
// Second derivatives of tau as checks: what is answered in double against the certified truth.
#pragma once

#include <vector>

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/prepared_scene.hpp"

namespace dynwitness::crosscheck {

/** At one seeded state the sweep of recursive/second_derivatives.hpp in double, entry by entry
    within its running error bounds of what it says in balls, with its digits. (That the formula is
    the right one is decided over the field: exact/second_derivative_checks.hpp.) Where the
    sweep does not go (whyNoSecondSweep()): not answerable, and why.
    @param answering  what is answered in double instead of the scene: tests plant their errors
      there */
std::vector<CheckResult> checkSecondDerivatives(const PreparedScene& scene, const Options& options,
                                                const PreparedScene* answering = nullptr);

}  // namespace dynwitness::crosscheck
