// SPDX-License-Identifier: GPL-3.0-or-later
// How much a program says beside its results, and in which colours: the options that all commands
// have.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace dynwitness::cli {

/// How progress is told on standard error.
enum class ProgressAs {
  kAuto,  ///< a bar on a terminal, lines otherwise
  kJson,  ///< one JSON object a line (progress.schema.json)
  kOff
};

/// What the words of the command line ask for.
struct Speech {
  std::string color = "auto";  ///< or always, never
  std::string progress = "auto";
  bool quiet = false;  ///< on standard error nothing but failures

  ProgressAs progressAs() const;
  /// Whether results are coloured: always, or where standard output is a terminal that is not
  /// dumb and NO_COLOR (no-color.org) is not set.
  bool isColored() const;
};
/// Of this process.
Speech& speech();

/// --color, --progress and -q, --quiet
void addSpeech(CLI::App& command);
/// Takes -q and --quiet from the words before they are parsed, since parsing may tell.
void readQuiet(const std::vector<std::string>& words);

enum class Tone { kGood, kBad, kDoubt };
/// A word of a result, on standard output, in the colour of its tone.
std::string toned(Tone tone, const std::string& word);
/// A verdict by what it says: agree, right, yes, named; disagree, wrong, NO, FAILED, could not be
/// run; all else is doubt.
std::string tonedVerdict(const std::string& padded);
/// What `check` says, with its verdicts in colour: the second word of "  M          wrong  ..", and
/// the last line.
std::string tonedReport(const std::string& text);

}  // namespace dynwitness::cli
