// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness growth: time, memory and digits against the number of links.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/growth/growth.hpp"
#include "crosscheck/growth/ours.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/families.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;
struct Arguments {
  GrowthOptions options;
  std::vector<std::string> witnesses;
  std::string output, json;
  PictureLook look;
};

void writeGrowth(const std::vector<GrowthPoint>& points, const GrowthOptions& options, double cache,
                 const std::string& folder, const PictureLook& look) {
  std::vector<ChartScript> scripts;
  for (const std::string& family : options.families)
    scripts.push_back({family, growthScript(points, family, cache, kChartStyle)});
  writeCharts({{"growth", growthCsv(points, options, cache)}}, scripts, folder, look);
}

int run(const Arguments& arguments) {
  std::vector<WitnessKind> engines;
  for (const WitnessKind& kind :
       arguments.witnesses.empty() ? witnessKinds() : selectWitnesses(arguments.witnesses))
    if (kind.info.version != DYNWITNESS_VERSION) engines.push_back(kind);
  if (!arguments.output.empty()) requireWritableFolder(arguments.output);
  requireWritableFile(arguments.json);
  const std::size_t sizes = growthSizes(arguments.options.most_links).size();
  std::vector<GrowthPoint> points;
  {
    Progress progress(static_cast<int>(sizes * arguments.options.families.size()));
    points =
        growth(engines, arguments.options, [&](const std::string& what) { progress.stage(what); });
  }
  const double cache = lastLevelCache();
  fmt::print("{}", growthCsv(points, arguments.options, cache));
  if (!arguments.json.empty())
    writeWholeFile(arguments.json,
                   growthJson(points, arguments.options, cache, DYNWITNESS_VERSION));
  if (!arguments.output.empty())
    writeGrowth(points, arguments.options, cache, arguments.output, arguments.look);
  // times are told, and not judged: another program may have been running
  bool holds = true;
  for (const GrowthPoint& p : points)
    if (p.method == kFastMethod || p.method == kTextbookMethod) holds = holds && p.failure.empty();
  for (const GrowthGoal& goal : growthGoals(points, cache))
    if (!goal.is_time && goal.isMeasured()) holds = holds && goal.isReached();
  return holds ? 0 : 1;
}

}  // namespace

Run addGrowth(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("--family", arguments->options.families,
                   "Chains, binary trees; both with a comma")
      ->capture_default_str()
      ->delimiter(',')
      ->check(oneOf({"chain", "tree"}));
  command
      ->add_option("--links", arguments->options.most_links,
                   "Most links; smaller ones by powers of 4")
      ->capture_default_str()
      ->check(whole(1, scene::kMostFamilyLinks));
  command
      ->add_option("--truth", arguments->options.most_links_with_truth,
                   "Most links whose error is measured: certifying 4096 takes seconds")
      ->capture_default_str()
      ->check(whole(0, scene::kMostFamilyLinks));
  command
      ->add_option(
          "--patience", arguments->options.patience,
          "CPU time [s] for an engine at one size; one that needs more is asked for no larger one")
      ->capture_default_str()
      ->check(between(1, 100000));
  addSeed(*command, arguments->options.seed, "of the state");
  command
      ->add_option("--witness", arguments->witnesses,
                   "Witnesses: outside engines beside our own sweeps; without: all that are there")
      ->delimiter(',');
  addOutput(*command, arguments->output, "folder for growth.csv and chain, tree .gp and .svg");
  addPictures(*command, arguments->look);
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n  dynwitness growth --family chain --links 4096\n"
      "  dynwitness growth --links 1000000 -o growth --json growth.json\n"
      "Units: ns of CPU time, and bytes, a link. What is counted stands in the lines before the "
      "table; the\n"
      "goals and what was reached, after it. 10^6 links take 3 GB.\n"
      "Exit status 1: a goal that is no time is missed (memory, digits), or one of our sweeps "
      "failed.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
