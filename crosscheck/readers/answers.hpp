// SPDX-License-Identifier: GPL-3.0-or-later
// What a program has read, found from M and g, where it says no more.
#pragma once

#include <cstdint>
#include <vector>

#include "crosscheck/readers/compare.hpp"

namespace dynwitness::crosscheck {

/** The mistakes that turn M and g of the file into those of a program.

    First one mistake for the whole robot: gravity, any rule at every link, any rule at one link or
    joint. Then link by link from the tips inward: row i of M (its entries up to the diagonal) and
    g_i depend on the links from i outward alone, so that with those outward known, a rule is found
    for link i. Where none fits, the least change of the ten numbers (mass, first and second
    moments) that gives the row is told: it is what M and g can tell of them, the base parameters;
    what lies inward of it is not looked at.

    @param positions  q, one a body, one list a state
    @param said       M and g there, by the program
    @return  none: it has the robot of the file, as far as M and g can tell */
std::vector<Misreading> explainAnswers(const FileParts& file,
                                       const std::vector<std::vector<double>>& positions,
                                       const std::vector<MassAndGravity>& said,
                                       const std::string& reader, int states, std::uint64_t seed);

}  // namespace dynwitness::crosscheck
