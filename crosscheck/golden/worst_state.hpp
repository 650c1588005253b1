// SPDX-License-Identifier: GPL-3.0-or-later
// Where a quantity keeps few digits: a cheap seeded search.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "crosscheck/witnesses/prepared_scene.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// The worst state that was found.
struct WorstState {
  scene::State<double> state;
  double loss =
      0;  ///< largest limit over largest entry; 0: the quantity is 0 wherever it was asked
  double usual = 0;   ///< the same, median of the states that were drawn
  int looked_at = 0;  ///< states
};

/** Looks for a state where rounding may take most of the quantity: the largest limit of
    engine_bound.hpp, as a share of the largest entry. Draws states, every other one with its angles
    near quarter turns, and goes on from the worst by steps of one position or rate that make it
    worse. Costs a fixed number of O(n) sweeps (O(n^3) for qdd). It proves nothing about states that
    it did not look at. */
WorstState worstState(const PreparedScene& scene, Quantity quantity, std::uint64_t seed);

/** The same of any loss, a share of what is asked for (0: nothing is lost, or nothing is there), at
    the same draws and with the same steps. */
WorstState worstState(const PreparedScene& scene, Quantity quantity, std::uint64_t seed,
                      const std::function<double(const scene::State<double>&)>& loss);

/// The state that is drawn for this index, its numbers rounded to multiples of 2^-10; quaternions
/// are near length 1.
scene::State<double> plainState(const scene::Mechanism& mechanism, const std::string& name,
                                std::uint64_t seed, std::uint64_t index);

/// The nearest multiple of 2^-bits.
double onGrid(double x, int bits);

}  // namespace dynwitness::crosscheck
