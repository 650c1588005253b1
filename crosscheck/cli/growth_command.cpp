// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness growth: time, memory and digits against the number of links.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/crosscheck.hpp"
#include "crosscheck/growth/growth.hpp"
#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/files.hpp"
#include "crosscheck/report/plot.hpp"
#include "scene/families.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;
namespace fs = std::filesystem;

struct Arguments {
  GrowthOptions options;
  std::vector<std::string> witnesses;
  std::string output;
};

/// Data, scripts and pictures, whole files or none.
void writeGrowth(const std::vector<GrowthPoint>& points, const GrowthOptions& options,
                 const fs::path& folder) {
  const UnfinishedFolder work(folder);  // vanishes again
  const std::string style = "dynwitness_style.gp";
  work.write(style, kStyleGnuplot);
  work.write("growth.csv", growthCsv(points, options));
  std::vector<std::string> files = {style, "growth.csv"};
  std::string problem;
  for (const std::string& family : options.families) {
    work.write(family + ".gp", growthScript(points, family, style));
    files.push_back(family + ".gp");
    const std::vector<std::string> pictures = {family + ".svg", family + "_dark.svg"};
    if (const auto failure = runGnuplot(work.path(), family + ".gp", pictures)) problem = *failure;
    else files.insert(files.end(), pictures.begin(), pictures.end());
  }
  fs::create_directories(folder);
  for (const std::string& file : files) {
    std::ifstream stream(work.path() / file, std::ios::binary);
    writeWholeFile(folder / file, std::string(std::istreambuf_iterator<char>(stream), {}));
  }
  if (!problem.empty())
    throw std::runtime_error(
        fmt::format("no picture: {}; data and scripts are in {}", problem, folder.string()));
}

int run(const Arguments& arguments) {
  std::vector<WitnessKind> engines;
  for (const WitnessKind& kind :
       arguments.witnesses.empty() ? witnessKinds() : selectWitnesses(arguments.witnesses))
    if (kind.info.version != DYNWITNESS_VERSION) engines.push_back(kind);
  if (!arguments.output.empty()) requireWritableFolder(arguments.output);
  int sizes = 1;
  for (long n = 1; n < arguments.options.most_links; n *= 4) ++sizes;
  std::vector<GrowthPoint> points;
  {
    Progress progress(sizes * static_cast<int>(arguments.options.families.size()));
    points = growth(engines, arguments.options, [&](const std::string& what) { progress.stage(what); });
  }
  fmt::print("{}", growthCsv(points, arguments.options));
  if (!arguments.output.empty()) writeGrowth(points, arguments.options, arguments.output);
  return 0;
}

}  // namespace

Run addGrowth(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("growth", "Measure time, memory and digits against the number of links");
  command
      ->add_option("--family", arguments->options.families, "Chains, binary trees; both with a comma")
      ->capture_default_str()
      ->delimiter(',')
      ->check(CLI::IsMember({"chain", "tree"}));
  command->add_option("--links", arguments->options.most_links, "Most links; smaller ones by powers of 4")
      ->capture_default_str()
      ->check(CLI::Range(1, scene::kMostFamilyLinks));
  command
      ->add_option("--patience", arguments->options.patience,
                   "An engine that takes longer [s] at one size is not asked for a larger one")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--seed", arguments->options.seed, "Seed of the state")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--witness", arguments->witnesses,
                   "Outside engines beside our own sweeps; without: all that are there")
      ->delimiter(',');
  command->add_option("-o,--output", arguments->output,
                      "Folder for growth.csv and chain, tree .gp, .svg and _dark.svg");
  command->footer(
      "Examples:\n  dynwitness growth --family chain --links 4096\n"
      "  dynwitness growth --links 1000000 --witness simbody -o growth");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
