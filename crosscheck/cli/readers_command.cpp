// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness readers: what every engine makes of a robot description.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/readers/compare.hpp"
#include "crosscheck/readers/readers_page.hpp"
#include "crosscheck/system/environment.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/mjcf.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::cli {
namespace {

struct Arguments {
  std::string file, json, html, mend, plain;
  std::vector<std::string> engines;
  crosscheck::Limits limits;
  bool all = false;
  int states = 20;
  std::uint64_t seed = 1;
};

/// A program of the user's is asked once for its name and once a state or more.
crosscheck::ReaderLimits limitsOf(const Arguments& arguments) {
  crosscheck::ReaderLimits limits;
  limits.seconds = std::max(limits.seconds, 4 * arguments.limits.seconds);
  return limits;
}

/// The page, and the picture beside it.
void writePage(const Arguments& arguments, const std::string& text, const std::string& picture,
               const crosscheck::ReadersResult& result) {
  std::string drawn;
  try {
    drawn = crosscheck::readersPicture(text, arguments.file, result, DYNWITNESS_VERSION);
  } catch (const scene::InputError& error) {
    tell(fmt::format("dynwitness: no picture: {}\n", error.what()));
  }
  if (!drawn.empty()) crosscheck::writeWholeFile(picture, drawn);
  crosscheck::writeWholeFile(
      arguments.html, crosscheck::readersPage(
                          result, crosscheck::thisEnvironment(),
                          drawn.empty() ? "" : std::filesystem::path(picture).filename().string()));
  fmt::print("page: {}\n", arguments.html);
  if (drawn.empty()) return;
  constexpr std::size_t kLarge = 700000;
  fmt::print("picture: {}{}\n", picture,
             drawn.size() > kLarge
                 ? fmt::format(" ({:.1f} MB)", static_cast<double>(drawn.size()) / 1e6)
                 : "");
}

int run(const Arguments& arguments) {
  std::string picture;  // readers.html: readers.view.html
  if (!arguments.html.empty())
    picture = std::filesystem::path(arguments.html).replace_extension(".view.html").string();
  for (const std::string& file :
       {arguments.json, arguments.html, picture, arguments.mend, arguments.plain})
    crosscheck::requireWritableFile(file);
  const std::string text = scene::readTextFile(arguments.file, "a URDF or MJCF file");
  if (scene::isMjcf(text) && !(arguments.mend.empty() && arguments.plain.empty()))
    throw scene::InputError({arguments.file},
                            fmt::format("{} writes a URDF, and this is MJCF, allowed: a URDF file",
                                        arguments.mend.empty() ? "--plain" : "--mend"));
  const crosscheck::ReadersResult result = crosscheck::examineReaders(
      text, arguments.file, crosscheck::engineReaders(arguments.engines, arguments.limits),
      arguments.states, arguments.seed, limitsOf(arguments));
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
  if (!arguments.html.empty()) writePage(arguments, text, picture, result);
  if (!result.anyRead() && result.agrees()) {
    tellFailure(fmt::format("dynwitness: {}: no engine reads the file\n", arguments.file));
    return 2;
  }
  return result.agrees() ? 0 : 1;
}

}  // namespace

Run addReaders(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command->add_option("file", arguments->file, "URDF or MJCF file")->required();
  command->add_flag("--all-links", arguments->all, "All links in the table, not only what differs");
  addRandom(*command, arguments->states, 10000, "for M and g");
  addSeed(*command, arguments->seed, "of the states");
  addEngineOptions(*command, arguments->engines, arguments->limits);
  addJson(*command, arguments->json);
  command->add_option("--html", arguments->html,
                      "Write the result as a page, one file; and a picture beside it, .view.html");
  command->add_option("--mend", arguments->mend,
                      "Write the file with impossible inertias replaced by the nearest possible "
                      "ones, each change a comment");
  command->add_option("--plain", arguments->plain,
                      "Write the robot with fixed links merged and inertias in link axes");
  command->footer(
      "Examples:\n"
      "  dynwitness readers my_arm.urdf\n"
      "  dynwitness readers my_arm.xml\n"
      "  dynwitness readers my_arm.urdf --all-links --json readers.json --html readers.html\n"
      "  dynwitness readers my_arm.urdf --engine \"python3 my_reader.py\"\n"
      "  dynwitness readers my_arm.urdf --mend mended.urdf\n"
      "Exit status: 0 every engine that reads the file has its robot; 1 one has another robot, "
      "crashes or\n"
      "hangs; 2 no URDF or MJCF, or no engine reads it.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
