// SPDX-License-Identifier: GPL-3.0-or-later
// What a lecturer asks for: how submissions are started, what they may use, and the marks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "crosscheck/system/children.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// One scene, and what its quantities are worth.
struct RubricTask {
  scene::Scene scene;
  /// By what `check` judges: names of quantities, and "jacobian".
  std::vector<std::pair<std::string, double>> marks;
};

struct Rubric {
  std::string command;  ///< a shell's words; {file} is the submission
  std::string main;     ///< of a folder: the file that is started. Empty: the only one in it
  std::string build;    ///< a shell's words, once before. Empty: nothing is built
  std::vector<std::pair<std::string, std::string>> files;  ///< laid beside it: name, bytes
  std::vector<std::string> environment;                    ///< variables that it gets
  std::vector<std::filesystem::path> hide;                 ///< what it must not see besides
  Limits limits;
  double build_seconds = 60;
  double disk = 0.1;  ///< [GB]
  bool single = false;
  std::uint64_t seed = 1;
  double partial = 0;  ///< share of the marks where one named mistake explains all answers
  std::map<std::string, double> partial_by_rule;
  std::vector<RubricTask> tasks;

  double outOf() const;
  /// The share that a quantity keeps whose only mistake this is.
  double share(const std::string& rule) const;
  /// Everything of it that the answers of a submission depend on: all but the marks.
  std::string runKey() const;
};

/// @throws scene::InputError  file and line, what was read, and what is allowed
Rubric readRubric(const std::filesystem::path& file);

/// A rubric that can be used as it stands, with comments.
const char* exampleRubric();

}  // namespace dynwitness::crosscheck
