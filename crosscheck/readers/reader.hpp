// SPDX-License-Identifier: GPL-3.0-or-later
// Programs that read robot descriptions, each with its own defaults.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/readers/robot.hpp"

namespace dynwitness::crosscheck {

/// What a reader made of a file.
struct Reading {
  std::string refusal;  ///< in its own words; empty: it has read
  Robot robot;
  std::vector<std::string> told;  ///< conventions and circumstances, which are no finding
  /// M and g by the engine itself, q one a body of `robot`; empty: it does not say.
  std::function<MassAndGravity(const std::vector<double>& q)> answer;
};

/** A reader: a name, and what it makes of bytes. */
struct Reader {
  std::string name, version;
  bool present = true;
  /// @param file  where the text came from: meshes are looked for beside it
  std::function<Reading(const std::string& text, const std::filesystem::path& file)> read;
};

/// One source each (NAME_reader.cpp); without its engine the source is a stub.
Reader mujocoReader();
Reader dartReader();

/// All but ours.
std::vector<Reader> engineReaders();

}  // namespace dynwitness::crosscheck
