// SPDX-License-Identifier: GPL-3.0-or-later
// A scene in another format, and what that format cannot hold.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::scene {

enum class Format { kToml, kUrdf, kMjcf };

/// "toml", "urdf", "mjcf"
const char* name(Format format);

struct WrittenScene {
  std::string text;  ///< with a comment a line of `lost`, and of what reading had left out
  std::vector<std::string> lost;  ///< what of the scene does not come back when the text is read
};

/// @throws InputError  the format has no word for a joint
WrittenScene writeSceneAs(const Scene& scene, Format format);

}  // namespace dynwitness::scene
