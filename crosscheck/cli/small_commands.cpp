// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness scenes, version.
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/system/environment.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

namespace {

/// Scenes that a number makes: names and what they are.
constexpr std::pair<const char*, const char*> kFamilies[] = {
    {"four_bars_N", "N = 1 to 200 four-bar windows (IFToMM A02)"},
    {"chain_N, tree_N", "N = 1 to 1000000 equal links, in a row or as a binary tree"},
    {"flat_chain_N", "the same row with all axes parallel"}};

void addFormat(CLI::App& command, std::string& format) {
  command.add_option("--format", format, "How it is written: what is printed")
      ->capture_default_str()
      ->check(oneOf({"text", "json"}));
}

int printScenes(bool is_json) {
  nlohmann::json all = {{"dynwitness", DYNWITNESS_VERSION}, {"scenes", nlohmann::json::array()}};
  for (const auto& file : scene::bundledScenes()) {
    const scene::Scene scene = scene::readScene(file);
    if (is_json)
      all["scenes"].push_back(
          {{"name", scene.name}, {"dof", scene.mechanism.dof()}, {"title", scene.title}});
    else
      fmt::print("{:<24} {:>2} dof  {}\n", scene.name, scene.mechanism.dof(), scene.title);
  }
  for (const auto& [names, what] : kFamilies)
    if (is_json)
      all["families"].push_back({{"names", names}, {"what", what}});
    else
      fmt::print("{:<24}         {}\n", names, what);
  if (is_json) fmt::print("{}\n", all.dump(2));
  return 0;
}

int printVersion(bool is_json) {
  const Environment environment = thisEnvironment();
  if (is_json) {
    nlohmann::json all = {
        {"dynwitness", environment.version},    {"commit", environment.commit},
        {"compiler", environment.compiler},     {"flags", environment.flags},
        {"witnesses", nlohmann::json::array()}, {"libraries", nlohmann::json::array()}};
    for (const WitnessKind& kind : witnessKinds()) {
      all["witnesses"].push_back({{"name", kind.info.name},
                                  {"present", kind.info.present},
                                  {"version", kind.info.version},
                                  {"method", kind.info.method}});
      if (!kind.info.absent.empty()) all["witnesses"].back()["absent"] = kind.info.absent;
    }
    for (const Environment::Library& library : environment.libraries)
      all["libraries"].push_back({{"name", library.name}, {"version", library.version}});
    fmt::print("{}\n", all.dump(2));
    return 0;
  }
  fmt::print("dynwitness {}{}\n", environment.version,
             environment.commit.empty() ? "" : " (" + environment.commit + ")");
  for (const WitnessKind& kind : witnessKinds())
    fmt::print("witness {:<18} {:<8} {}\n", kind.info.name,
               kind.info.present ? kind.info.version : "absent",
               kind.info.absent.empty() ? kind.info.method : kind.info.absent);
  for (const Environment::Library& library : environment.libraries)
    fmt::print("library {:<18} {}\n", library.name, library.version);
  fmt::print("compiler {} {}\n", environment.compiler, environment.flags);
  return 0;
}

}  // namespace

Run addScenes(CLI::App* command) {
  auto features = std::make_shared<bool>(false);
  auto format = std::make_shared<std::string>("text");
  CLI::Option* as_table = command->add_flag(
      "--features", *features, "What each command makes of each part of a scene, in markdown");
  addFormat(*command, *format);
  command->get_option("--format")->excludes(as_table);
  command->footer("Examples:\n  dynwitness scenes\n  dynwitness scenes --format json");
  return [features, format] {
    if (!*features) return printScenes(*format == "json");
    fmt::print("{}", featuresMarkdown());
    return 0;
  };
}

Run addVersion(CLI::App* command) {
  auto format = std::make_shared<std::string>("text");
  addFormat(*command, *format);
  command->footer("Examples:\n  dynwitness version\n  dynwitness version --format json");
  return [format] { return printVersion(*format == "json"); };
}

}  // namespace dynwitness::cli
