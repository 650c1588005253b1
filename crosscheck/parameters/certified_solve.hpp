// SPDX-License-Identifier: GPL-3.0-or-later
// The regrouping once more, enclosed in balls. In a file of its own: balls compile for long.
#pragma once

#include <cstdint>

#include "crosscheck/parameters/base_parameters.hpp"

namespace dynwitness::crosscheck {

/** Fills in value and error of K. Y is stacked at seeded states of doubles in ball arithmetic, and
    Y_1 K = Y_2 is solved by elimination with the largest pivots: that they do not contain zero
    proves Y_1 independent at the scene's own angles. Precision grows until 80 bits of every entry
    are certain, or that it is below 2^-80: those are taken out of K.
    @throws std::logic_error  an entry of K that is zero over the field is certainly not zero here,
      or the other way round, or a rational is outside its ball */
void encloseCoefficients(const scene::Scene& scene, std::uint64_t seed, BaseParameters& base);

}  // namespace dynwitness::crosscheck
