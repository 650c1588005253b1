// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes with joints that move no inertia: a tool link without mass at the tip of a URDF. M has a
// zero on its diagonal there: M, c, g and tau = M qdd + c + g are numbers, qdd is none.
#pragma once

#include <filesystem>
#include <string>

#include "scene/scene.hpp"

namespace dynwitness::scene {

/// Whether joints have to move inertia. What solves with M needs it of all, what does not, of none.
enum class InertiaNeed { kOfNoJoint, kOfEachJoint };

/** findScene(), readScene(), validate() and the readers of texts as scene.hpp and mjcf.hpp have
    them, who need it of each joint; kOfNoJoint leaves out that one rule of validate(). */
Scene findScene(const std::string& name_or_path, InertiaNeed need);
Scene readScene(const std::filesystem::path& file, InertiaNeed need);
Scene readSceneToml(const std::string& text, const std::filesystem::path& file, InertiaNeed need);
Scene readSceneUrdf(const std::string& text, const std::filesystem::path& file, InertiaNeed need);
Scene readSceneMjcf(const std::string& text, const std::filesystem::path& file, InertiaNeed need);
void validate(const Scene& scene, InertiaNeed need);

/** That rule alone, of a scene that is valid otherwise.
    @param asked  for what it is needed: "qdd"
    @throws InputError  `FILE:LINE: joint "J" of link "L": ...`, the first joint that moves no
      inertia, and what was asked */
void requireInertiaOfJoints(const Scene& scene, const std::string& asked);

}  // namespace dynwitness::scene
