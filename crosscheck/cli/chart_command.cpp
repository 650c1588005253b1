// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness chart: speed against accuracy of all methods that compute the same quantity.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/chart/chart.hpp"
#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/simulation_chart.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/report/chart_drawing.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

constexpr const char* kAll = "all";

struct ChartArguments {
  GivenScene scene;
  std::string output;
  std::vector<std::string> quantities = {name(Quantity::kTau)}, witnesses, engines;
  Limits limits;  ///< of these programs
  int states = 1000;
  std::uint64_t seed = 1;
  PictureLook look;
};

/// Each quantity asked for once, in the order of the charts.
std::vector<Quantity> quantitiesOf(const ChartArguments& arguments) {
  const auto asked = [&](const char* text) {
    return std::count(arguments.quantities.begin(), arguments.quantities.end(), text) > 0;
  };
  std::vector<Quantity> quantities;
  for (const Quantity quantity : chartedQuantities())
    if (asked(name(quantity)) || asked(kAll)) quantities.push_back(quantity);
  return quantities;
}

int runChart(const ChartArguments& arguments) {
  const scene::Scene scene = admitted(arguments.scene, Command::kChart);
  requireMotion(scene);
  // without names the absent ones too: the table says that they are
  std::vector<WitnessKind> kinds =
      arguments.witnesses.empty() ? witnessKinds() : selectWitnesses(arguments.witnesses);
  for (const WitnessKind& kind : engineKinds(arguments.engines, arguments.limits, scene))
    kinds.push_back(kind);
  if (!arguments.output.empty()) requireWritableFolder(arguments.output);
  const std::vector<Quantity> quantities = quantitiesOf(arguments);
  std::vector<Chart> charts;
  {
    Progress progress(static_cast<int>(quantities.size()));
    for (const Quantity quantity : quantities) {
      progress.stage(fmt::format("{} of {}", name(quantity), scene.name));
      charts.push_back(speedAccuracy(scene, quantity, kinds, arguments.states, arguments.seed));
    }
  }
  fmt::print("{}", chartCsv(charts));
  if (arguments.output.empty()) return 0;
  std::vector<ChartData> data;
  std::vector<ChartScript> scripts;
  for (const Chart& chart : charts) {
    const std::string stem = safeName(chart.scene) + "_" + chart.quantity;
    data.push_back({stem, chartCsv({chart})});
    scripts.push_back({stem, chartScript(chart, stem, kChartStyle)});
  }
  writeCharts(data, scripts, arguments.output, arguments.look);
  return 0;
}

}  // namespace

Run addChart(CLI::App* command) {
  auto arguments = std::make_shared<ChartArguments>();
  addScene(*command, arguments->scene, "Scene");
  const auto simulation = addSimulationChart(command);
  std::vector<std::string> allowed;
  for (const Quantity quantity : chartedQuantities()) allowed.push_back(name(quantity));
  allowed.push_back(kAll);
  command
      ->add_option(
          "--quantity", arguments->quantities,
          "Quantities: mass matrix, inverse dynamics, forward dynamics; several with commas")
      ->capture_default_str()
      ->delimiter(',')
      ->check(oneOf(allowed));
  addRandom(*command, arguments->states, 100000, "each method is run at these");
  addSeed(*command, arguments->seed, "of the states");
  command
      ->add_option("--witness", arguments->witnesses,
                   "Witnesses: outside engines beside our own methods; without: all that are there")
      ->delimiter(',');
  addEngineOptions(*command, arguments->engines, arguments->limits);
  for (const char* of_questions : {"--quantity", "--random", "--seed", "--witness", "--engine"})
    command->get_option(of_questions)->excludes(command->get_option("--simulate"));
  addOutput(*command, arguments->output,
            "folder for SCENE_QUANTITY (or _simulate) .csv, .gp and .svg");
  addPictures(*command, arguments->look);
  command->footer(
      "Examples:\n"
      "  dynwitness chart franka_panda --quantity all -o charts\n"
      "  dynwitness chart double_pendulum --simulate -o charts");
  return [arguments, simulation] {
    return simulation->is_asked ? runSimulationChart(arguments->scene, *simulation,
                                                     arguments->output, arguments->look)
                                : runChart(*arguments);
  };
}

}  // namespace dynwitness::cli
