// SPDX-License-Identifier: GPL-3.0-or-later
// All that is asked of a scene over the prime field.
#pragma once

#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** Runs the comparisons of witnesses and the identities of identities.hpp over the field.

    A point is a prime, a state, and a value for whatever of the scene's numbers has no place in a
    field (FieldNumbers); it is a pure function of (scene name, seed, index). A point at
    which a check divides by zero is drawn again, for that check. errorProbability() in
    formula_sizes.hpp says what the chance is a chance of, and why no formula that differs is exempt
    from it.

    @return  one result a pair and quantity ("same") and one an identity, unit "exact"; `states` and
      `exact` say at how many points the residual was zero, or at which it was not. A check is
             not answerable when a divisor is zero at all points, or when its formulas are too large
             for the field to say anything.
    @throws std::invalid_argument unless 0 < error_probability < 1 */
std::vector<CheckResult> exactChecks(const PreparedScene& scene, const ExactOptions& options);

}  // namespace dynwitness::crosscheck
