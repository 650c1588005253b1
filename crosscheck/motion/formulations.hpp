// SPDX-License-Identifier: GPL-3.0-or-later
// One motion by every form of its constraints, or by several methods: what each costs, how far it
// drifts, how right it is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/motion/simulate.hpp"

namespace dynwitness::crosscheck {

/// "index1", "index2", "index3", "ggl"
const char* name(Formulation formulation);
/// "none", "baumgarte", "projection"
const char* name(Stabilisation stabilisation);

struct FormulationRun {
  Formulation formulation;
  Stabilisation stabilisation;
  std::string method;
  std::string failure;  ///< why there is no result; empty: there is one
  Simulation result;
  double q_error = 0,
         qd_error = 0;  ///< largest difference from the reference at outputs [rad, m; 1/s]
  std::optional<double> lambda_error;  ///< the same of determined multipliers; none without
};

struct FormulationComparison {
  SimulateOptions reference;  ///< of the run that errors are measured against
  Simulation reference_run;
  double most_lambda = 0;  ///< largest determined multiplier of the reference
  std::vector<FormulationRun> runs;
};

/// How many runs a comparison has.
inline constexpr int kComparedFormulations = 8;

/** Runs index 1 (by the explicit method of the options: without help, Baumgarte, projection; by
    Radau IIA: without help, projection), index 2, index 3 and Gear, Leimkuhler and Gupta's (Radau
    IIA), from the same start. Errors are differences from an index 1 run with projection at the
    smallest step error that double precision serves, 1000 eps. The multipliers of a singular pose
    or of redundant equations are left out: mechanics does not say what they are. */
FormulationComparison compareFormulations(const scene::Scene& scene,
                                          const SimulateOptions& options);

/// The same of one form of the constraints, that of the options, by these methods.
/// @throws scene::InputError  as simulate(), of any of them
FormulationComparison compareMethods(const scene::Scene& scene, const SimulateOptions& options,
                                     const std::vector<std::string>& methods);

}  // namespace dynwitness::crosscheck
