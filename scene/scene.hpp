// SPDX-License-Identifier: GPL-3.0-or-later
// A scene: a mechanism and what is asked of it, from a file and back.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/mechanism.hpp"

namespace dynwitness::scene {

struct Scene {
  std::string name;  ///< file name without folder and extension
  std::string title;
  std::string source;  ///< where the figures come from
  std::filesystem::path file;
  Mechanism mechanism;
  /// One a position slot, followers where their leaders put them; default Mechanism::restPosition()
  std::vector<Number> start_q;
  std::vector<Number> start_qd;           ///< one a degree of freedom; default 0
  std::vector<std::string> not_modelled;  ///< what the file says and dynwitness leaves out

  Scene();
  Scene(const Scene&);
  Scene(Scene&&) noexcept;
  Scene& operator=(const Scene&);
  Scene& operator=(Scene&&) noexcept;
  ~Scene();
};

/** Reads a scene from a TOML or URDF file, told apart by content, and validates it.
    @throws InputError  `file:line: ...`, on anything missing, unknown, undefined, cyclic, not
      finite or physically impossible. */
Scene readScene(const std::filesystem::path& file);

/// The same for TOML text that is already in memory; `file` is used in messages and as the name.
Scene readSceneToml(const std::string& text, const std::filesystem::path& file);
/// The same for URDF text.
Scene readSceneUrdf(const std::string& text, const std::filesystem::path& file);

/// The scene as TOML. Reading the text again gives the same scene, and writing that the same text.
std::string writeSceneToml(const Scene& scene);

/** The scene as URDF. Links, joints, placements and mass properties are all there, fixed joints
    too; gravity, rotors, springs and loads, for which URDF has no words, are named in a comment.
    Links that stand in Denavit-Hartenberg rows hang on a massless link NAME.joint_frame.
    @throws InputError when a joint is of a kind that URDF has not: helical, cylindrical, universal,
    spherical */
std::string writeSceneUrdf(const Scene& scene);

/// The URDF for a program that reads URDF itself: the scene's own file where it is one and still
/// says what the scene says, without its shapes; otherwise writeSceneUrdf(). Joints that follow
/// others are let go in it: engines read <mimic> as a servo or not at all, and are asked for the
/// tree (witnesses/coupled.hpp).
std::string urdfForEngines(const Scene& scene);

/// Checks that need the whole mechanism: names, masses, inertias, axes, singular leaves.
/// @throws InputError naming the link, the value and the rule.
void validate(const Scene& scene);

/// The folder with scenes/ and reference/ in it: the environment variable DYNWITNESS_DATA, or where
/// the build or the installation put it.
std::filesystem::path dataFolder();
/** A row of `windows` four-bar linkages, the benchmark A02: windows + 1 uprights on the ground,
    joined by as many bars less one, all rods of 1 m and 1 kg, moving in the xy plane. It starts
    upright. In each of its flat poses every window may fold either way: the rank of J falls by
    `windows`. */
Scene fourBars(int windows);

/// The scene of this name in the folder of bundled scenes, the file of this path, a scene of the
/// published tables in data/reference, or four_bars_N.
/// @throws InputError listing the names that exist when it is neither.
Scene findScene(const std::string& name_or_path);
/// The bundled scenes, in alphabetical order, as paths.
std::vector<std::filesystem::path> bundledScenes();

}  // namespace dynwitness::scene
