// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/on_the_stand.hpp"

#include "crosscheck/cli/door.hpp"
#include "crosscheck/diagnosis/examine.hpp"

namespace dynwitness::cli {

scene::Scene onTheStand(const std::string& name) {
  scene::Scene scene = crosscheck::withoutFollowers(admitted(name, crosscheck::Command::kCheck));
  crosscheck::requireMotion(scene);
  return scene;
}

}  // namespace dynwitness::cli
