// SPDX-License-Identifier: GPL-3.0-or-later
// Derivations read back from what was printed of them: what a person reads is what is proven.
#pragma once

#include <string>

#include "symbolic/derivation.hpp"

namespace dynwitness::symbolic {

struct ReadBack {
  int formulas = 0;     ///< how many were read and compared
  std::string problem;  ///< the first that says something else, or cannot be read; empty: none
  /// A wrong formula is equal at a random point with a chance of at most its degree / 2^61; of this
  /// many points, for any degree below 1000: kReadBackChance.
  int points = 0;
};
constexpr double kReadBackChance = 2e-31;

/** Reads every equation of a printed derivation as a person would who knows its letters: signs,
    products, fractions, powers, cosines and sines of sums of angles, by the rules of the notation
    and with nothing of the printers but the spelling of single names. Each right side is evaluated
    in the integers modulo 2^61 - 1, at random values of all parameters, rates and positions and
    random points of the circle for all angles, and compared with the equations' own program (of an
    equation of motion: both sides).

    @param document  print(derivation, style), whatever stands around it
    @param style     kText, kLatex or kMathml */
ReadBack readBack(const Derivation& derivation, const std::string& document, Style style);

}  // namespace dynwitness::symbolic
