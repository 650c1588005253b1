// SPDX-License-Identifier: GPL-3.0-or-later
// How many digits survive: every witness against the certified truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/crosscheck.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** What is left of one quantity by one witness, over the states of a crosscheck.

    Digits are counted against the quantity as a whole,
        digits = -log10( max_i |x_i - truth_i| / max_i |truth_i| ),
    because an entry that should be 0 has no digits of its own. Distance to the truth means to the
    farthest point of its enclosure, so no digit is counted that is not there. Digits that a
    scalar has no room for are not counted either: 9 in float, 17 in double, 21 in long double
    (max_digits10). */
struct DigitsResult {
  std::string scene, witness, quantity;
  std::string scalar;                   ///< "double"; our sweeps in "float" and "long double" too
  int states = 0;                       ///< that have digits: the truth is certified and not 0
  std::optional<double> worst, median;  ///< digits over those states; empty when there are none
  /// Fewest digits of a single entry against itself, over entries that are not 0.
  std::optional<double> worst_single;
  int worst_state = 0;      ///< where `worst` is
  std::string worst_entry;  ///< the entry farthest from the truth there
  /// Largest distance to the truth / the witness's own error bound, over all entries and states.
  /// Empty for float and long double, where no bound is computed.
  std::optional<double> bound_ratio;
  /// Where there are bounds: disagree when an entry at some state is proven to lie outside its
  /// bound, agree when all lie within (where the truth's own width, below 2^-80 of it, does not
  /// count).
  std::optional<Verdict> verdict;
  std::string reason;  ///< of a disagreement: which joint, which state; or why it is not answerable
};

/** Every quantity that the witnesses answer, at the options' states: all witnesses in double,
    judged by the bounds of their answers; then the sweeps in float and long double. A float run
    gets the state rounded to float: that rounding is part of what float does, and is counted. */
std::vector<DigitsResult> measureDigits(const scene::Scene& scene,
                                        const std::vector<WitnessKind>& kinds,
                                        const Options& options);

}  // namespace dynwitness::crosscheck
