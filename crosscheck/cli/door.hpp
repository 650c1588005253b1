// SPDX-License-Identifier: GPL-3.0-or-later
// What each command does first with a scene that it was given.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/inputs/features.hpp"

namespace dynwitness::cli {

/// Lets a scene in: tells on standard error what the commands leave out of it.
/// @throws scene::InputError  what one of them refuses (crosscheck/inputs/features.hpp)
void admit(const scene::Scene& scene, const std::vector<crosscheck::Command>& commands);

/// The scene of this name or file, let in.
scene::Scene admitted(const std::string& name, crosscheck::Command command);

}  // namespace dynwitness::cli
