// SPDX-License-Identifier: GPL-3.0-or-later
// Long formulas on pages: browsers end no line within a math element.
#pragma once

#include <string>

namespace dynwitness::symbolic {

/** An equation as several math elements side by side, between which a line may end: in front of a
    plus or minus that stands in no fraction, power, matrix or short parentheses. A short equation
    stays one.
    @param math  print(Equation, Style::kMathml)
    @return elements for a line of text; the first begins with "<math xmlns" */
std::string inPieces(const std::string& math);

/// A page with the pieces of each equation put together again: all parts of the formulas, each in
/// one math element.
std::string withoutPieces(const std::string& page);

}  // namespace dynwitness::symbolic
