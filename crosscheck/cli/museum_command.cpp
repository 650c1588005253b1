// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness museum: mistakes of real tools, planted again; the check has to name each of them.
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/speech.hpp"
#include "crosscheck/diagnosis/museum.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/processes.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  std::vector<std::string> exhibits;
  std::string json;
  int processes = availableProcessors();
};

/// The scene of this name or file as `check` asks about it.
scene::Scene onTheStand(const std::string& name) {
  scene::Scene scene = withoutFollowers(admitted({name, "", {}}, Command::kCheck));
  requireMotion(scene);
  return scene;
}

int run(const Arguments& arguments) {
  requireWritableFile(arguments.json);
  const Museum museum = bundledMuseum();
  const std::vector<MuseumPiece> pieces = selectPieces(museum, arguments.exhibits);
  MuseumFound found;
  {
    const Progress progress("museum");
    found = walkThrough(museum, pieces, onTheStand, arguments.processes);
  }
  fmt::print("{}", arguments.exhibits.empty() ? museumTable(found, tonedVerdict)
                                              : tonedReport(museumInFull(found, tonedVerdict)));
  if (!arguments.json.empty())
    writeWholeFile(arguments.json, museumJson(found, DYNWITNESS_VERSION));
  return found.holds() ? 0 : 1;
}

}  // namespace

Run addMuseum(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command->add_option("exhibit", arguments->exhibits,
                      "Exhibits by name, each shown in full, with its link and what the check "
                      "says; without: all, as a table");
  addJson(*command, arguments->json);
  addProcesses(*command, arguments->processes);
  command->footer(
      "Examples:\n"
      "  dynwitness museum\n"
      "  dynwitness museum bullet_merge_com\n"
      "Exit status: 0 each mistake is found and is what is named first, and the engine without a "
      "mistake is right;\n"
      "1 otherwise.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
