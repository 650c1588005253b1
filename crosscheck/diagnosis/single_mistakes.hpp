// SPDX-License-Identifier: GPL-3.0-or-later
// Explanations by one mistake, by one number that is another, or by single precision. For the
// search of explanations (explain.cpp) alone.
#pragma once

#include <vector>

#include "crosscheck/diagnosis/found_mistakes.hpp"

namespace dynwitness::crosscheck::explaining {

void addSingles(const Case& all, const std::vector<Hypothesis>& list, Search& out);
void addEstimates(const Case& all, const std::vector<Suspect>& list, Search& out);

inline constexpr double kSingle = 0x1p29;  ///< roundings of float in those of double

/// Whether every number is one of single precision, those aside that are solved for.
bool isRounded(const std::vector<Exhibit>& exhibits);
/// Smaller errors than those of a float are no float's.
bool isOfSingle(double relative, bool rounded);
Explanation singlePrecision(bool rounded);
/// All that is wrong is so by no more than single precision loses.
void addSingle(const Case& all, bool rounded, Search& out);

}  // namespace dynwitness::crosscheck::explaining
