// SPDX-License-Identifier: GPL-3.0-or-later
// What simulate says of a run: constraints, energy, how far off it may be, events, publications.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "crosscheck/motion/motion_tables.hpp"
#include "crosscheck/motion/simulate.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

/// What a run cost and how far it was off, for programs.
nlohmann::json jsonOf(const crosscheck::Simulation& result);
nlohmann::json jsonOf(const crosscheck::MotionTable& table,
                      const crosscheck::MotionVerdict& verdict);
nlohmann::json jsonOf(const crosscheck::Simulation::Task& task);
/// Of which scene and how long, as every JSON of simulate begins.
nlohmann::json jsonHead(const scene::Scene& scene, const crosscheck::SimulateOptions& options);

/// "radau_iia_5, steps of 0.001 s" or "runge_kutta_dopri5, error of a step 1e-10"
std::string describe(const crosscheck::SimulateOptions& options);

/// A run, and what it is held against.
struct SimulatedRun {
  const scene::Scene& scene;
  const crosscheck::SimulateOptions& options;
  const std::string& until;                            ///< as --until has it; empty: no event
  const std::vector<crosscheck::MotionTable>& tables;  ///< published motions
  const crosscheck::Simulation& result;
  const crosscheck::Simulation* rerun;  ///< at half the error; none: not asked, or it failed
  std::string no_rerun;                 ///< why it failed
};

/** Prints the summary and adds it to the JSON.
    @return  whether the rerun shares digits, events are all there and published motions are met
    @throws std::runtime_error  energy or constraints are not finite along the motion */
bool reportRun(const SimulatedRun& run, nlohmann::json* all);

}  // namespace dynwitness::cli
