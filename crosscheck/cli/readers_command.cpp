// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness readers: what every engine makes of a robot description.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/readers/compare.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::cli {
namespace {

struct Arguments {
  std::string file, json, mend, plain;
  bool all = false;
  int states = 20;
  std::uint64_t seed = 1;
};

int run(const Arguments& arguments) {
  for (const std::string& file : {arguments.json, arguments.mend, arguments.plain})
    crosscheck::requireWritableFile(file);
  const std::string text = scene::readTextFile(arguments.file, "a URDF file");
  const crosscheck::ReadersResult result = crosscheck::examineReaders(
      text, arguments.file, crosscheck::engineReaders(), arguments.states, arguments.seed);
  fmt::print("{}", crosscheck::readersText(result, arguments.all));
  if (!arguments.mend.empty()) {
    std::vector<std::string> changes;
    const std::string mended = scene::mendedUrdf(text, arguments.file, &changes);
    crosscheck::writeWholeFile(arguments.mend, mended);
    for (const std::string& change : changes) fmt::print("mended: {}\n", change);
    fmt::print("{}: written, {} inertias replaced by the nearest possible\n", arguments.mend,
               changes.size());
  }
  if (!arguments.plain.empty())
    crosscheck::writeWholeFile(
        arguments.plain, crosscheck::plainUrdf(scene::readUrdfAsWritten(text, arguments.file)));
  if (!arguments.json.empty())
    crosscheck::writeWholeFile(arguments.json, crosscheck::readersJson(result, DYNWITNESS_VERSION));
  if (!result.anyRead()) {
    tell(fmt::format("dynwitness: {}: no engine reads the file\n", arguments.file));
    return 2;
  }
  return result.agrees() ? 0 : 1;
}

}  // namespace

Run addReaders(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("readers", kReadersDescription);
  command->add_option("file", arguments->file, "URDF file")->required();
  command->add_flag("--all", arguments->all, "All links in the table, not only what differs");
  command->add_option("--states", arguments->states, "Seeded states for M and g")
      ->check(whole(1, 10000))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Seed of the states")
      ->check(seed())
      ->capture_default_str();
  command->add_option("--json", arguments->json, "Write the result to this file");
  command->add_option("--mend", arguments->mend,
                      "Write the file with impossible inertias replaced by the nearest possible "
                      "ones, each change a comment");
  command->add_option("--plain", arguments->plain,
                      "Write the robot with fixed links merged and inertias in link axes");
  command->footer(
      "Examples:\n"
      "  dynwitness readers my_arm.urdf\n"
      "  dynwitness readers my_arm.urdf --all --json readers.json\n"
      "  dynwitness readers my_arm.urdf --mend mended.urdf\n"
      "Exit status: 0 every engine that reads the file has its robot; 1 one has another robot; 2 no "
      "URDF, or\n"
      "no engine reads it.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
