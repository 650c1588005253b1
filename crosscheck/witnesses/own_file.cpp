// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/own_file.hpp"

#include <filesystem>

#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Where nobody can have been given it, nobody is asked.
bool isUrdfFile(const scene::Scene& scene) {
  std::error_code error;
  return scene.file.extension() == ".urdf" && std::filesystem::is_regular_file(scene.file, error);
}

}  // namespace

bool isOwnFile(const std::string& urdf, const scene::Scene& told) {
  if (!isUrdfFile(told)) return false;
  scene::Scene tree = told;
  tree.mechanism = scene::withoutMimics(told.mechanism);
  return urdf != scene::writeSceneUrdf(tree);
}

std::vector<std::string> readersOfOwnFile(const PreparedScene& scene,
                                          const std::vector<WitnessKind>& kinds) {
  std::vector<std::string> names;
  if (!isUrdfFile(scene.scene())) return names;
  for (const WitnessKind& kind : kinds) {
    // its card says who may; the others need not be made for it
    if (kind.info.convention("reads").rfind("URDF", 0) != 0) continue;
    const MadeWitness made = kind.make(scene.tree());
    if (made.isRefused()) continue;
    const auto* reader = dynamic_cast<const FileReader*>((*made).get());
    if (reader != nullptr && reader->readsOwnFile()) names.push_back(kind.info.name);
  }
  return names;
}

}  // namespace dynwitness::crosscheck
