// SPDX-License-Identifier: GPL-3.0-or-later
// Which value of a number explains best what was said. For the search of explanations (explain.cpp
// and what it includes) alone.
#pragma once

#include <optional>
#include <vector>

#include "crosscheck/diagnosis/compared_answers.hpp"
#include "crosscheck/diagnosis/suspects.hpp"

namespace dynwitness::crosscheck::explaining {

/** The value of a suspect number that comes nearest, on top of a belief. Forces are polynomials of
    second degree at most in each of them, so that three predictions give the whole function of one;
    several are sought by Gauss and Newton (an inertia's six enter linearly).
    @param quick  only whether there is such a value of one number
    @return       nothing: no value brings the predictions within the limits */
std::optional<VectorXd> estimated(const Case& all, const std::vector<const Exhibit*>& exhibits,
                                  const Belief& base, const Suspect& suspect, VectorXd* uncertainty,
                                  bool quick = false);

}  // namespace dynwitness::crosscheck::explaining
