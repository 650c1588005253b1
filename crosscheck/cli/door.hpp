// SPDX-License-Identifier: GPL-3.0-or-later
// What each command does first with a scene that it was given.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "crosscheck/inputs/features.hpp"
#include "scene/changes.hpp"
#include "scene/envelope.hpp"

namespace dynwitness::cli {

/// Lets a scene in: tells on standard error what the commands leave out of it.
/// @throws scene::InputError  what one of them refuses (crosscheck/inputs/features.hpp)
void admit(const scene::Scene& scene, const std::vector<crosscheck::Command>& commands);

/// What a command is given for a scene.
struct GivenScene {
  std::string name;  ///< or its file
  std::string root;  ///< the link that its tree starts from; empty: as it is written
  scene::Changes changes;

  bool isAsWritten() const { return root.empty() && changes.isNone(); }
};
/// The scene of a command, its --root, --gravity, --base and --set.
/// @param what  "Scene", and of which kind
void addScene(CLI::App& command, GivenScene& scene, const std::string& what);
/// The options alone, of commands that take several scenes.
std::vector<CLI::Option*> addChanges(CLI::App& command, GivenScene& scene);

/// The scene, with progress where that takes long.
/// @throws scene::InputError  there is none, it cannot be read, be changed so
///   (scene::changed()) or have this root (crosscheck::rooted()), which needs inertia of each joint
scene::Scene readScene(const GivenScene& given,
                       scene::InertiaNeed need = scene::InertiaNeed::kOfEachJoint);

/** The scene of which numbers are asked: each joint has to move inertia only where they take the
    inverse of M.
    @param solved  a quantity that does, "qdd"; empty: none
    @throws scene::InputError  as readScene(); of a joint that moves no inertia with what was
    asked */
scene::Scene readSceneFor(const GivenScene& given, const std::string& solved);

/// The file that a scene stands in, also where changes leave it none of its own.
std::filesystem::path fileOf(const GivenScene& given, const scene::Scene& scene);

/// [envelope] of its file for the scene as it is read: ranges are expressions in the parameters
/// that it has then. None: the file has no such table.
/// @throws scene::InputError  as scene::readEnvelope(), which a scene of other joints may meet
std::vector<scene::JointRanges> envelopeOf(const GivenScene& given, const scene::Scene& scene);

/// The scene, let in.
scene::Scene admitted(const GivenScene& given, crosscheck::Command command,
                      scene::InertiaNeed need = scene::InertiaNeed::kOfEachJoint);

}  // namespace dynwitness::cli
