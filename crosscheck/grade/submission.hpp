// SPDX-License-Identifier: GPL-3.0-or-later
// What somebody handed in: a file, or a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "crosscheck/grade/rubric.hpp"

namespace dynwitness::crosscheck {

/// Its bytes, as they were read.
struct Submission {
  struct File {
    std::filesystem::path path;  ///< within the submission
    std::string bytes;
    bool is_executable = false;
  };
  std::string name;
  std::vector<File> files;           ///< by path
  std::vector<std::string> remarks;  ///< what was left out
  std::string problem;               ///< not empty: it cannot be run, and why
  std::string start;                 ///< of the files the one that is started
};

/// The names of all that lies in a folder, in their order, but for what begins with a dot.
/// @throws scene::InputError  it is no folder, cannot be read, or holds nothing
std::vector<std::string> submissionsIn(const std::filesystem::path& folder);

/** Reads one. Links are not followed, and are left out.
    @throws std::runtime_error  something cannot be read: no fault of the submission's */
Submission readSubmission(const std::filesystem::path& folder, const std::string& name,
                          const Rubric& rubric);

/// A hash of all that its examination depends on: its bytes, the rubric but for the marks, and this
/// program.
std::string keyOf(const Submission& submission, const Rubric& rubric);

/// Writes it and what the rubric lays beside it; files of its own come first.
void layOut(const Submission& submission, const Rubric& rubric,
            const std::filesystem::path& folder);

/// The words that start or build it, {file} filled in.
std::string commandFor(const Submission& submission, std::string words);

}  // namespace dynwitness::crosscheck
