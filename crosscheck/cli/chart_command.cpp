// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness chart: speed against accuracy of all methods that compute the same quantity.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/chart/chart.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/chart_drawing.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;
namespace fs = std::filesystem;

constexpr const char* kAll = "all";
/// Named so that it meets no file of the user's.
constexpr const char* kStyleFile = "dynwitness_style.gp";

struct Arguments {
  std::string scene, output;
  std::vector<std::string> quantities = {name(Quantity::kTau)}, witnesses, engines;
  Limits limits;  ///< of these programs
  int states = 1000;
  std::uint64_t seed = 1;
};

/// Each quantity asked for once, in the order of the charts.
std::vector<Quantity> quantitiesOf(const Arguments& arguments) {
  const auto asked = [&](const char* text) {
    return std::count(arguments.quantities.begin(), arguments.quantities.end(), text) > 0;
  };
  std::vector<Quantity> quantities;
  for (const Quantity quantity : chartedQuantities())
    if (asked(name(quantity)) || asked(kAll)) quantities.push_back(quantity);
  return quantities;
}

/// Data, script and pictures of each chart; a picture that gnuplot does not finish is named, and
/// leaves its data and script all the same.
void writeCharts(const std::vector<Chart>& charts, const fs::path& folder) {
  const UnfinishedFolder work(folder);  // vanishes again
  work.write(kStyleFile, kStyleGnuplot);
  std::vector<std::string> files = {kStyleFile};
  std::string problem;
  for (const Chart& chart : charts) {
    const std::string stem = safeName(chart.scene) + "_" + chart.quantity;
    const std::vector<std::string> pictures = {stem + ".svg", stem + "_dark.svg"};
    work.write(stem + ".csv", chartCsv({chart}));
    work.write(stem + ".gp", chartScript(chart, stem, kStyleFile));
    files.insert(files.end(), {stem + ".csv", stem + ".gp"});
    if (const auto failure = runGnuplot(work.path(), stem + ".gp", pictures))
      problem = *failure;
    else
      files.insert(files.end(), pictures.begin(), pictures.end());
  }
  fs::create_directories(folder);
  for (const std::string& file : files) {
    std::ifstream stream(work.path() / file, std::ios::binary);
    writeWholeFile(folder / file, std::string(std::istreambuf_iterator<char>(stream), {}));
  }
  if (!problem.empty())
    throw std::runtime_error(
        fmt::format("no picture: {}; data and script are in {}", problem, folder.string()));
}

int run(const Arguments& arguments) {
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
  if (!arguments.output.empty()) writeCharts(charts, arguments.output);
  return 0;
}

}  // namespace

Run addChart(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command->add_option("scene", arguments->scene, "Scene")->required();
  std::vector<std::string> allowed;
  for (const Quantity quantity : chartedQuantities()) allowed.push_back(name(quantity));
  allowed.push_back(kAll);
  command
      ->add_option("--quantity", arguments->quantities,
                   "Mass matrix, inverse dynamics, forward dynamics; several with commas")
      ->capture_default_str()
      ->delimiter(',')
      ->check(CLI::IsMember(allowed));
  command->add_option("--states", arguments->states, "Seeded states that each method is run at")
      ->capture_default_str()
      ->check(whole(1, 100000));
  command->add_option("--seed", arguments->seed, "Seed of the states")
      ->capture_default_str()
      ->check(seed());
  command
      ->add_option("--witness", arguments->witnesses,
                   "Outside engines beside our own methods; without: all that are there")
      ->delimiter(',');
  addEngineOptions(*command, arguments->engines, arguments->limits);
  command->add_option("-o,--output", arguments->output,
                      "Folder for SCENE_QUANTITY.csv, .gp, .svg and _dark.svg");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
