// SPDX-License-Identifier: GPL-3.0-or-later
// --point LINK[,x,y,z]: a point of a link.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::cli {

struct PointAsked {
  int link;
  std::vector<std::string> at;  ///< x, y, z in the link's axes, as given [m]; none: its origin
};

/// "hand", "hand,0,0,l/2". @throws scene::InputError  no such link, or not three coordinates
PointAsked pointAsked(const std::string& text, const scene::Scene& scene);

}  // namespace dynwitness::cli
