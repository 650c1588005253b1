// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/door.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/remarks.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/motion/rooted.hpp"
#include "scene/mjcf.hpp"
#include "scene/remarks.hpp"
#include "scene/text_file.hpp"
#include "scene/urdf.hpp"

namespace dynwitness::cli {

void admit(const scene::Scene& scene, const std::vector<crosscheck::Command>& commands) {
  std::vector<std::string> told;
  for (const crosscheck::Command command : commands) {
    crosscheck::requireTreated(scene, command);
    for (const std::string& sentence : crosscheck::leftOut(scene, command))
      if (std::find(told.begin(), told.end(), sentence) == told.end()) told.push_back(sentence);
  }
  for (const std::string& sentence : told)
    tell(fmt::format("{}: left out: {}\n", scene.name, sentence));
}

void addScene(CLI::App& command, GivenScene& scene, const std::string& what) {
  command.add_option("scene", scene.name, what)->required();
  addChanges(command, scene);
}

std::vector<CLI::Option*> addChanges(CLI::App& command, GivenScene& scene) {
  CLI::Option* gravity =
      command.add_option("--gravity", scene.changes.gravity,
                         "Another gravity: x,y,z in world axes [m/s^2]; 0,0,0 is none");
  gravity->type_name("x,y,z");
  CLI::Option* base = command.add_option(
      "--base", scene.changes.base,
      "floating: what rests in the world floats in it, by a joint floating_base; fixed: what floats "
      "in the world is fixed where the start has it");
  base->check(oneOf({"floating", "fixed"}));
  CLI::Option* set = command.add_option(
      "--set", scene.changes.sets,
      fmt::format("Another number of the scene: {}; again for more. What the scene's own file or "
                  "published tables say is not held against it then",
                  fmt::join(scene::setNames(), ", ")));
  set->type_name("NAME=VALUE")->allow_extra_args(false);
  CLI::Option* root = command.add_option(
      "--root", scene.root,
      "The link that the tree starts from: the same mechanism in other coordinates. It floats (seven q, "
      "six qd: `dynwitness show` lists all); joints between it and the former start are turned round and "
      "keep their q, spherical ones have the conjugate quaternion, universal and planar ones are "
      "refused. What rested in the world is held there by a weld");
  return {gravity, base, set, root};
}

namespace {

/// A scene that is to be changed: what nobody takes as it is (a tip without mass, a URDF with
/// inertias of no body) may be one afterwards.
scene::Scene foundToBeChanged(const std::string& name) {
  try {
    return scene::findScene(name, scene::InertiaNeed::kOfNoJoint);
  } catch (const scene::InputError&) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(name, error)) throw;
    const std::string text = scene::readTextFile(name, "a TOML, URDF or MJCF file");
    if (!scene::looksLikeXml(text) || scene::isMjcf(text)) throw;
    return scene::readUrdfAsWritten(text, name).scene;
  }
}

}  // namespace

scene::Scene readScene(const GivenScene& given, scene::InertiaNeed need) {
  const Progress progress("reading " + given.name);
  scene::Scene scene;
  try {
    scene = given.changes.isNone()
                ? scene::findScene(given.name, need)
                : scene::changed(foundToBeChanged(given.name), given.changes, need);
  } catch (const scene::InputError&) {
    remark(scene::remarksOnFile(given.name));  // which may be why
    throw;
  }
  remark(remarksOn(given, scene));
  return given.root.empty() ? scene : crosscheck::rooted(scene, given.root);
}

scene::Scene readSceneFor(const GivenScene& given, const std::string& solved) {
  if (solved.empty()) return readScene(given, scene::InertiaNeed::kOfNoJoint);
  try {
    return readScene(given);
  } catch (const scene::InputError&) {
    scene::requireInertiaOfJoints(readScene(given, scene::InertiaNeed::kOfNoJoint), solved);
    throw;  // it is something else
  }
}

std::filesystem::path fileOf(const GivenScene& given, const scene::Scene& scene) {
  return given.isAsWritten() ? scene.file
                             : scene::findScene(given.name, scene::InertiaNeed::kOfNoJoint).file;
}

std::vector<scene::JointRanges> envelopeOf(const GivenScene& given, const scene::Scene& scene) {
  scene::Scene of_file = scene;
  of_file.file = fileOf(given, scene);
  return scene::readEnvelope(of_file);
}

scene::Scene admitted(const GivenScene& given, crosscheck::Command command,
                      scene::InertiaNeed need) {
  scene::Scene scene = readScene(given, need);
  admit(scene, {command});
  return scene;
}

}  // namespace dynwitness::cli
