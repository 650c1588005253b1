// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness show: which q is which joint, what the links weigh, what is modelled; and the picture.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/remarks.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/exact/ledger.hpp"
#include "crosscheck/report/show.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::cli {
namespace {

using crosscheck::Shown;

struct ShowArguments {
  GivenScene scene;
  std::string page, format = "text";
};

/// The text of the URDF that a file is; empty: it is none.
std::string urdfText(const std::filesystem::path& file) {
  std::error_code error;
  if (file.empty() || !std::filesystem::is_regular_file(file, error)) return {};
  const std::string text = scene::readTextFile(file, "a TOML or URDF file");
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");  // byte order mark
  const bool is_xml = first != std::string::npos && text[first] == '<';
  return is_xml && text.find("<robot") != std::string::npos ? text : std::string();
}

/// Whether what is wrong with the scene hinders those quantities alone that take the inverse of M.
bool isWholeWithoutInverse(const GivenScene& given) {
  try {
    readSceneFor(given, "");
    return true;
  } catch (const scene::InputError&) {
    return false;
  }
}

/// The scene; a URDF that no motion can be computed of is shown as it is written, and why.
Shown read(const GivenScene& given) {
  Shown shown;
  try {
    shown.scene = readScene(given);
  } catch (const scene::InputError& error) {
    const std::string text = given.isAsWritten() ? urdfText(given.name) : std::string();
    if (text.empty()) throw;
    scene::Urdf urdf = scene::readUrdfAsWritten(text, given.name);
    shown = {std::move(urdf.scene), std::move(urdf.parts), {}};
    shown.warnings = scene::impossibleInertias(shown.scene);
    if (shown.warnings.empty()) {
      shown.warnings.emplace_back(error.what());
      shown.has_no_inverse = isWholeWithoutInverse(given);
    }
    return shown;
  }
  if (const std::string text = urdfText(shown.scene.file); !text.empty())
    shown.parts = scene::readUrdfAsWritten(text, shown.scene.file).parts;
  return shown;
}

int runShow(const ShowArguments& arguments) {
  crosscheck::requireWritableFile(arguments.page);
  Shown shown = read(arguments.scene);
  shown.remarks = remarksOn(arguments.scene, shown.scene);
  admit(shown.scene, {crosscheck::Command::kShow});
  if (shown.warnings.empty()) shown.ledger = crosscheck::ledgerOf(shown.scene);
  for (const std::string& warning : shown.warnings)
    tell(fmt::format("{}: {}\n", shown.scene.name, warning));
  fmt::print("{}", arguments.format == "json" ? crosscheck::showJson(shown, DYNWITNESS_VERSION)
                                              : crosscheck::showText(shown));
  if (!arguments.page.empty())
    crosscheck::writeWholeFile(
        arguments.page, crosscheck::showPage(shown, crosscheck::viewOf(shown.scene, shown.parts),
                                             DYNWITNESS_VERSION));
  return 0;
}

}  // namespace

Run addShow(CLI::App* command) {
  auto arguments = std::make_shared<ShowArguments>();
  addScene(*command, arguments->scene, "Scene");
  addOutput(*command, arguments->page, "of the picture, one HTML file that needs no network");
  command->add_option("--format", arguments->format, "How it is written: what is printed")
      ->check(oneOf({"text", "json"}))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  dynwitness show puma_560\n"
      "  dynwitness show my_arm.urdf -o my_arm.html\n"
      "The ledger says what the equations of motion take: parameters that matter, entries of M, c\n"
      "and g that are always zero and why, operations with and without them.\n"
      "A URDF that other commands refuse (inertias of no body), or some of them do (a massless tip\n"
      "has no qdd), is shown as it is written, with the reason.");
  return [arguments] { return runShow(*arguments); };
}

}  // namespace dynwitness::cli
