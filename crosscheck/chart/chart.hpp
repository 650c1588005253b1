// SPDX-License-Identifier: GPL-3.0-or-later
// Speed against accuracy: every method that computes the same quantity, measured in one run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "crosscheck/scalars/scalar.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// One method in one scalar.
struct ChartPoint {
  std::string method;  ///< "Newton-Euler sweep", "straight-line program", "simbody", ...
  Scalar scalar = Scalar::kDouble;
  /// Largest |entry - truth| / largest |truth| of a state, over the states (rounded up; balls count
  /// to their far ends).
  double error_worst = 0, error_median = 0;
  /// CPU time of one evaluation [ns], over batches of states and repeats: fastest, median, 90 %.
  double time_min_ns = 0, time_median_ns = 0, time_high_ns = 0;
};

struct Chart {
  std::string scene, title, quantity;
  int states = 0;
  std::uint64_t seed = 0;
  std::string machine;  ///< model name of the processor
  std::vector<ChartPoint> points;
  std::vector<std::string> left_out;   ///< methods that do not apply, each with the reason
  std::vector<std::string> own_calls;  ///< of engines: what is in their time, or why not their own
};

/// How it is measured: the truth is certified to 2^-bits, to judge 50 digits too; one time is taken
/// for each batch of states, in rounds over all methods.
inline constexpr long kChartTruthBits = 200;
inline constexpr int kChartBatches = 20, kChartRounds = 5;

/** Lets every method compute the same quantity at the same states in the same run.

    All start from q, qd and qdd (or tau) as numbers, so that cosines, sines and the places of links
    (position kinematics) are in the time, and end with the numbers of the quantity. In double: the
    closed form evaluated as it is printed (up to three joints; every cosine and product where it
    stands), the derived straight-line program, the sweep, for qdd also the mass matrix with L D L',
    the fast sweeps, the kernel one state at a time and all states of a batch in lanes, and the
    outside engines among `kinds`: their errors are those of Witness::value(), their times those of
    their own calls (raw_engines.hpp), or where an engine is not called so, of Witness::value(),
    which its name then says. The closed form and the program solve for qdd by L D L'. The sweep
    also runs in float, long double, 50 decimal digits and balls of 128 bits. Programs are
    interpreted here; compiled ones are faster. Of programs that are asked (engine_protocol.hpp) it
    is wall time, with all that is said, a batch at a time. Rounds over all methods are repeated, so
    that a change of the machine's pace meets all of them.

    @param quantity  one of chartedQuantities()
    @throws std::invalid_argument  on another quantity
    @throws scene::InputError      where there is no truth: M is singular at one of the states */
Chart speedAccuracy(const scene::Scene& scene, Quantity quantity,
                    const std::vector<WitnessKind>& kinds, int states = 1000,
                    std::uint64_t seed = 1);

/// M, tau and qdd: what the sweeps of a chart compute.
const std::vector<Quantity>& chartedQuantities();

}  // namespace dynwitness::crosscheck
