// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/on_the_stand.hpp"

#include "crosscheck/cli/door.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::cli {

scene::Scene onTheStand(const std::string& name) {
  scene::Scene scene = admitted(name, crosscheck::Command::kCheck);
  crosscheck::requireMotion(scene);
  if (scene.mechanism.hasMimics()) {
    scene.mechanism = scene::withoutMimics(scene.mechanism);
    scene.start_qd.assign(static_cast<std::size_t>(scene.mechanism.dof()), scene::Number(0));
  }
  return scene;
}

}  // namespace dynwitness::cli
