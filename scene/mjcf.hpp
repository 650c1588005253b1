// SPDX-License-Identifier: GPL-3.0-or-later
// MJCF, MuJoCo's own format: an explicit subset (scene/mjcf.md), read and written.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::scene {

/// Whether the outermost element of an XML text is <mujoco>.
bool isMjcf(const std::string& text);

/** Reads MJCF text as a scene and validates it. The world is the root link; a body is a link, whose
    frame is the body's, moved to the anchor of the body's last joint; of several joints in a body
    the inner ones get massless links BODY.JOINT. A position of the scene is MuJoCo's qpos less ref;
    rates of free joints are in the axes of the body.
    @param file  for messages, as the name, and for the folder of the files that it includes
    @throws InputError  what is outside the subset, by name; and as readScene() does */
Scene readSceneMjcf(const std::string& text, const std::filesystem::path& file);

/** The scene as MJCF: a body a link, inertias as given, joints with springs, friction and armature,
    closures that are connect and weld, followers as equality, the start as a keyframe.
    @param lost  one line for each thing of the scene that the text does not say
    @throws InputError  a joint is helical, or links are nested deeper than readers of MJCF take */
std::string writeSceneMjcf(const Scene& scene, std::vector<std::string>* lost);

}  // namespace dynwitness::scene
