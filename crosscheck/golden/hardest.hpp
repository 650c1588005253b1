// SPDX-License-Identifier: GPL-3.0-or-later
// The hardest known states: where each engine keeps the fewest digits of a quantity.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "crosscheck/golden/golden.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** Digits are -log10( max_i |x_i - truth_i| / max_i |truth_i| ), the truth certified; 17 at most, 0
    at least. */
struct EngineLoss {
  std::string engine;
  Quantity quantity = Quantity::kM;
  double usual = 0;    ///< digits kept at half of the states that are drawn
  double worst = 0;    ///< digits kept at the hardest state
  double allowed = 0;  ///< that a program of the usual kinds may be left with there (the limits)
  int state = 0;       ///< the hardest one: its index in the golden vectors
};

struct Hardest {
  Golden golden;  ///< a group a quantity, answered; a state may be the hardest of several
  std::vector<EngineLoss> losses;  ///< quantity by quantity
};

struct HardestOptions {
  std::vector<Quantity> quantities;  ///< empty: M, c, g, tau, qdd
  std::vector<WitnessKind> engines;  ///< that testify in double
  std::uint64_t seed = 1;
};

/** Searches, for each engine and quantity, by worstState(): without slopes, seeded, over the ranges
    that states are drawn from; then each engine is asked at what was found for the others. It
    proves nothing about states that it did not look at. Engines that refuse the scene, and
    quantities that are 0 wherever the search looked, are in golden.left_out. Costs some 200
    certified truths an engine and quantity.
    @param scene  a tree, no joint of which follows another */
Hardest hardestStates(const scene::Scene& scene, const HardestOptions& options);

/// What each engine loses at worst, as rows of a table in Markdown, beside what it usually does.
std::string hardestTable(const Hardest& hardest);

}  // namespace dynwitness::crosscheck
