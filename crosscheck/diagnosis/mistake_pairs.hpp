// SPDX-License-Identifier: GPL-3.0-or-later
// Explanations by two mistakes, of which those come first whose effects add up to what is wrong.
// For the search of explanations (explain.cpp) alone.
#pragma once

#include <vector>

#include "crosscheck/diagnosis/found_mistakes.hpp"

namespace dynwitness::crosscheck::explaining {

/** Two mistakes; where none explain, a mistake and a number that is another one, or two numbers.
    @return  where none explains, either: the mistakes that come nearest alone */
std::vector<CheckFinding> addPairs(const Case& all, const std::vector<Hypothesis>& list,
                                   const std::vector<Suspect>& numbers, Search& out);

}  // namespace dynwitness::crosscheck::explaining
