// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness chart --simulate: what the accuracy of whole simulations costs.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "crosscheck/cli/door.hpp"
#include "crosscheck/motion/work_precision.hpp"
#include "crosscheck/report/plot.hpp"

namespace dynwitness::cli {

struct SimulationChartArguments {
  bool is_asked = false;
  crosscheck::WorkOptions options;
};

/// --simulate, --method, --duration.
std::shared_ptr<SimulationChartArguments> addSimulationChart(CLI::App* command);

/// @param output  folder for SCENE_simulate.csv, .gp and pictures; "": none
int runSimulationChart(const GivenScene& scene, const SimulationChartArguments& arguments,
                       const std::string& output, const crosscheck::PictureLook& look);

}  // namespace dynwitness::cli
