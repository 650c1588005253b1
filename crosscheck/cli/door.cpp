// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/door.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/motion/rooted.hpp"

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
  addRoot(command, scene.root);
}

CLI::Option* addRoot(CLI::App& command, std::string& root) {
  return command.add_option(
      "--root", root,
      "The link that the tree starts from: the same mechanism in other coordinates. It floats (seven q, "
      "six qd: `dynwitness show` lists all); joints between it and the former start are turned round and "
      "keep their q, spherical ones have the conjugate quaternion, universal and planar ones are "
      "refused. What rested in the world is held there by a weld");
}

scene::Scene readScene(const GivenScene& given) {
  const Progress progress("reading " + given.name);
  const scene::Scene scene = scene::findScene(given.name);
  return given.root.empty() ? scene : crosscheck::rooted(scene, given.root);
}

scene::Scene admitted(const GivenScene& given, crosscheck::Command command) {
  scene::Scene scene = readScene(given);
  admit(scene, {command});
  return scene;
}

}  // namespace dynwitness::cli
