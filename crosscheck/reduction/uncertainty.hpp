// SPDX-License-Identifier: GPL-3.0-or-later
// What of a scene may be uncertain for bounds to be exact at corners: numbers that joint forces are
// linear in.
#pragma once

#include <vector>

#include "scene/uncertain_parameters.hpp"

namespace dynwitness::crosscheck {

/** Refuses parameters that tau and the other quantities are not of degree 1 in, each by itself.

    Of degree 1 they are in masses, inertias (com given by itself), rotor inertias, stiffnesses and
    friction; a function that is of degree 1 in each of several numbers is largest at a corner of
    their ranges. What an expression is of in a parameter is read from its text, so that m l - m l
    counts as m and l do.
    @throws scene::InputError  naming the parameter, and the number that stands in the way */
void requireLinear(const scene::Scene& scene,
                   const std::vector<scene::UncertainParameter>& parameters);

/// The scene with each parameter at its upper end, or at its lower one.
scene::Scene atCorner(const scene::Scene& scene,
                      const std::vector<scene::UncertainParameter>& parameters,
                      const std::vector<bool>& upper);

}  // namespace dynwitness::crosscheck
