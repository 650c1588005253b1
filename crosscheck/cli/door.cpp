// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/door.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/cli/standard_files.hpp"

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

scene::Scene admitted(const std::string& name, crosscheck::Command command) {
  scene::Scene scene = scene::findScene(name);
  admit(scene, {command});
  return scene;
}

}  // namespace dynwitness::cli
