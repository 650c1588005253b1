// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness write: a scene in another format.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/cli/uncertain_parameters.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/envelope.hpp"
#include "scene/formats.hpp"

namespace dynwitness::cli {
namespace {

struct WriteArguments {
  GivenScene scene;
  std::string format, output;
  bool lossy = false;
};

int runWrite(const WriteArguments& arguments) {
  crosscheck::requireWritableFile(arguments.output);
  const scene::Scene scene = readScene(arguments.scene, scene::InertiaNeed::kOfNoJoint);
  scene::Format format = scene::Format::kToml;
  for (const scene::Format f : {scene::Format::kUrdf, scene::Format::kMjcf})
    if (arguments.format == scene::name(f)) format = f;
  scene::WrittenScene written = scene::writeSceneAs(scene, format);
  if (!written.lost.empty() && !arguments.lossy) {
    std::string list;
    for (const std::string& what : written.lost) list += "\n  " + what;
    throw scene::InputError(
        {scene.file.string()},
        fmt::format("{} cannot hold, allowed: another format, or --lossy, which leaves it out:{}",
                    arguments.format, list));
  }
  for (const std::string& what : scene.not_modelled)
    tell(fmt::format("{}: not read: {}\n", scene.name, what));
  // from another root, on another base there are other joints
  const bool has_its_joints = arguments.scene.root.empty() && arguments.scene.changes.base.empty();
  if (format == scene::Format::kToml && has_its_joints)
    written.text += scene::writeEnvelope(scene, envelopeOf(arguments.scene, scene)) +
                    scene::writeUncertainParameters(uncertainParametersOf(arguments.scene, scene));
  else if (scene::hasEnvelope(
               scene::findScene(arguments.scene.name, scene::InertiaNeed::kOfNoJoint)))
    tell(fmt::format("{}: left out of the file: [envelope]\n", scene.name));
  for (const std::string& what : written.lost)
    tell(fmt::format("{}: lost: {}\n", scene.name, what));
  if (arguments.output.empty())
    fmt::print("{}", written.text);
  else
    crosscheck::writeWholeFile(arguments.output, written.text);
  return 0;
}

}  // namespace

Run addWrite(CLI::App* command) {
  auto arguments = std::make_shared<WriteArguments>();
  addScene(*command, arguments->scene, "Scene, TOML, URDF or MJCF file");
  command->add_option("--format", arguments->format, "How it is written")
      ->required()
      ->check(oneOf({"toml", "urdf", "mjcf"}));
  addOutput(*command, arguments->output, "file; without: standard output");
  command->add_flag("--lossy", arguments->lossy,
                    "Leave out what the format cannot hold, each as a comment");
  command->footer(
      "Examples:\n"
      "  dynwitness write my_arm.xml --format toml -o my_arm.toml\n"
      "  dynwitness write franka_panda --format mjcf -o panda.xml\n"
      "What is read again is the same robot ('dynwitness same A B'). Exit status: 0 written; 2 the "
      "format cannot\n"
      "hold all of it, or bad usage or input.");
  return [arguments] { return runWrite(*arguments); };
}

}  // namespace dynwitness::cli
