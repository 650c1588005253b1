// SPDX-License-Identifier: GPL-3.0-or-later
// What each command does first with a scene that it was given.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "crosscheck/inputs/features.hpp"

namespace dynwitness::cli {

/// Lets a scene in: tells on standard error what the commands leave out of it.
/// @throws scene::InputError  what one of them refuses (crosscheck/inputs/features.hpp)
void admit(const scene::Scene& scene, const std::vector<crosscheck::Command>& commands);

/// What a command is given for a scene.
struct GivenScene {
  std::string name;  ///< or its file
  std::string root;  ///< the link that its tree starts from; empty: as it is written
};
/// The scene of a command and its --root.
/// @param what  "Scene", and of which kind
void addScene(CLI::App& command, GivenScene& scene, const std::string& what);
/// --root LINK, of commands that take several scenes.
CLI::Option* addRoot(CLI::App& command, std::string& root);

/// The scene, with progress where that takes long.
/// @throws scene::InputError  there is none, it cannot be read, or have this root
///   (crosscheck::rooted())
scene::Scene readScene(const GivenScene& given);

/// The same, let in.
scene::Scene admitted(const GivenScene& given, crosscheck::Command command);

}  // namespace dynwitness::cli
