// SPDX-License-Identifier: GPL-3.0-or-later
// The scene about which a program is asked when it stands alone.
#pragma once

#include <string>

#include "scene/scene.hpp"

namespace dynwitness::cli {

/// The scene of this name or file, let in to `check`, with joints that follow others let go.
/// @throws scene::InputError  `check` refuses it, or nothing moves in it
scene::Scene onTheStand(const std::string& name);

}  // namespace dynwitness::cli
