// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness stability: where methods fail, family by family.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/stability/atlas_report.hpp"
#include "crosscheck/system/environment.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;
namespace fs = std::filesystem;

constexpr int kQuickSeverities = 9;
constexpr const char* kStyleFile = "dynwitness_style.gp";

struct Arguments {
  std::vector<std::string> families, witnesses, engines;
  Limits limits;
  std::string output = "stability";
  bool list = false, quick = false, resume = false;
};

std::string textOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

std::string commandOf(const Arguments& arguments) {
  std::string words = "dynwitness stability";
  for (const std::string& family : arguments.families) words += " " + family;
  if (arguments.quick) words += " --quick";
  for (std::size_t k = 0; k < arguments.witnesses.size(); ++k)
    words += (k == 0 ? " --witness " : ",") + arguments.witnesses[k];
  for (const std::string& engine : arguments.engines) words += " --engine \"" + engine + "\"";
  return words;
}

/// The page and all that it shows, whole files; the page last.
void writeAtlas(const std::vector<stability::Turned>& atlas, const Arguments& arguments) {
  const fs::path folder = arguments.output;
  UnfinishedFolder work(folder);
  work.write(kStyleFile, kStyleGnuplot);
  std::string problem;
  for (const stability::Turned& turned : atlas) {
    const std::string& name = turned.family;
    work.write(name + ".csv", stability::csvOf(turned));
    work.write(name + ".gp", stability::scriptOf(turned, kStyleFile));
    if (const auto failure = runGnuplot(work.path(), name + ".gp", {name + ".svg"}))
      problem = *failure;
  }
  work.write("stability.json", stability::atlasJson(atlas, DYNWITNESS_VERSION));
  work.write("index.html", stability::atlasPage(atlas, DYNWITNESS_VERSION, commandOf(arguments)));
  work.moveIntoPlace("index.html");
  fmt::print("report: {}\n", (folder / "index.html").string());
  if (!problem.empty())
    throw std::runtime_error(
        fmt::format("no picture: {}; data and scripts are in {}", problem, folder.string()));
}

int run(const Arguments& arguments) {
  if (arguments.list) {
    for (const stability::Family& family : stability::families())
      fmt::print("{:<18} {}; s: {}{}, {:.3g} to {:.3g}\n", family.name, family.title, family.dial,
                 family.unit.empty() ? "" : " [" + family.unit + "]", family.from, family.to);
    return 0;
  }
  std::vector<const stability::Family*> chosen;
  if (arguments.families.empty())
    for (const stability::Family& family : stability::families()) chosen.push_back(&family);
  for (const std::string& name : arguments.families)
    chosen.push_back(&stability::familyNamed(name));
  requireWritable(arguments.output);
  // what is complete stands beside the atlas until the whole of it does
  const fs::path kept = fs::path(arguments.output).string() + ".unfinished";
  requireWritableFolder(kept);

  std::vector<stability::Method> methods;
  std::string asked;
  stability::Settings settings;
  if (arguments.quick) settings.severities = kQuickSeverities;
  std::vector<WitnessKind> kinds = selectWitnesses(arguments.witnesses);
  for (const WitnessKind& kind : engineKinds(arguments.engines, arguments.limits,
                                             stability::harmlessCase(*chosen.front()).scene))
    kinds.push_back(kind);
  for (stability::Method& method : stability::methodsOf(kinds)) {
    if (arguments.quick && method.is_compiled) continue;
    asked += " " + method.name;
    methods.push_back(std::move(method));
  }
  const Environment environment = thisEnvironment();
  for (const std::string& engine : arguments.engines) asked += " \"" + engine + "\"";
  const std::string made_by = fmt::format("dynwitness {} {}, {} severities:{}", environment.version,
                                          environment.commit, settings.severities, asked);
  std::vector<stability::Turned> atlas;
  {
    Progress progress(static_cast<int>(chosen.size()), 0, false);
    scene::Work work("families", static_cast<double>(chosen.size()));
    for (const stability::Family* family : chosen) {
      progress.stage(family->name);
      const fs::path file = kept / (family->name + ".json");
      std::optional<stability::Turned> turned;
      if (arguments.resume) turned = stability::familyFromJson(textOf(file), made_by);
      if (turned) {
        work.done();
      } else {
        turned = stability::turn(*family, methods, settings);
        fs::create_directories(kept);
        writeWholeFile(file, stability::familyJson(*turned, made_by));
      }
      atlas.push_back(std::move(*turned));
    }
  }
  for (const stability::Turned& turned : atlas) fmt::print("{}\n", stability::tableOf(turned));
  writeAtlas(atlas, arguments);
  for (const stability::Family* family : chosen) fs::remove(kept / (family->name + ".json"));
  std::error_code others_are_in_it;
  fs::remove(kept, others_are_in_it);
  const int silent = stability::silentOf(atlas, true);
  fmt::print("wrong without a word: ours at {} severities, outside engines at {}\n", silent,
             stability::silentOf(atlas, false));
  fmt::print("warned of {} digits and more that were right: our estimates at {} severities\n",
             stability::kPlentyOfDigits, stability::falseAlarmsOf(atlas));
  return silent == 0 ? 0 : 1;
}

}  // namespace

Run addStability(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command->add_option("family", arguments->families, "These families only; without: all")
      ->delimiter(',');
  command
      ->add_option("--witness", arguments->witnesses,
                   "Witnesses: in double beside our sweeps in float; without: all that are there")
      ->delimiter(',');
  addEngineOptions(*command, arguments->engines, arguments->limits);
  addOutput(*command, arguments->output,
            "folder for index.html, stability.json, and data, script and picture of each family")
      ->capture_default_str();
  command->add_flag("--list", arguments->list, "The families and their dials");
  command->add_flag("--quick", arguments->quick, "Fewer severities, and nothing that is compiled");
  command->add_flag("--resume", arguments->resume,
                    "Go on with a run that was ended: families that it has finished are kept");
  command->footer(
      "Examples:\n  dynwitness stability\n  dynwitness stability gimbal,light_cart -o out\n"
      "  dynwitness stability heavy_tip --engine \"python3 my_arm.py\"\n"
      "A method has broken where fewer than 3 decimal digits of the certified truth are left, or it "
      "stops;\n"
      "the severity of that is found by bisection, to 10 %, and stands beside the one that theory "
      "says.\n"
      "Exit status 1: a method of ours, in double or in float, was wrong without a word.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
