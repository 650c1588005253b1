// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/speech.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "crosscheck/cli/options.hpp"

namespace dynwitness::cli {

ProgressAs Speech::progressAs() const {
  if (quiet || progress == "off") return ProgressAs::kOff;
  return progress == "json" ? ProgressAs::kJson : ProgressAs::kAuto;
}

bool Speech::isColored() const {
  if (color != "auto") return color == "always";
  const char* none = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return isatty(STDOUT_FILENO) != 0 && (none == nullptr || *none == '\0') &&
         (terminal == nullptr || std::string(terminal) != "dumb");
}

Speech& speech() {
  static Speech here;
  return here;
}

void addSpeech(CLI::App& command) {
  command
      .add_option("--color", speech().color,
                  "Colours of verdicts on standard output; auto: on a terminal, unless NO_COLOR is "
                  "set")
      ->capture_default_str()
      ->check(oneOf({"auto", "always", "never"}));
  command
      .add_option("--progress", speech().progress,
                  "Progress on standard error; auto: a bar on a terminal and lines otherwise; "
                  "json: one object a line, with done of total, seconds and seconds_left (null "
                  "while that is not known)")
      ->capture_default_str()
      ->check(oneOf({"auto", "json", "off"}));
  command.add_flag("-q,--quiet", speech().quiet,
                   "Nothing on standard error but failures: no progress, no remarks");
}

void readQuiet(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (word == "--") return;
    if (word == "-q" || word == "--quiet") speech().quiet = true;
  }
}

std::string toned(Tone tone, const std::string& word) {
  if (!speech().isColored()) return word;
  const char* code = tone == Tone::kGood ? "32" : tone == Tone::kBad ? "1;31" : "33";
  return "\033[" + std::string(code) + "m" + word + "\033[0m";
}

std::string tonedVerdict(const std::string& padded) {
  const auto says = [&](const char* word) { return padded.find(word) != std::string::npos; };
  for (const char* word :
       {"disagree", "DISAGREE", "wrong", "WRONG", "NO", "NAMED ONLY", "FAILED", "could not be run"})
    if (says(word)) return toned(Tone::kBad, padded);
  if (says("not answerable") || says("cannot say")) return toned(Tone::kDoubt, padded);
  for (const char* word : {"agree", "right", "yes", "named"})
    if (says(word)) return toned(Tone::kGood, padded);
  return toned(Tone::kDoubt, padded);
}

std::string tonedReport(const std::string& text) {
  constexpr std::size_t kVerdict = 13, kWidth = 10;  // where it stands in a line
  if (!speech().isColored()) return text;
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line); out += line + "\n") {
    if (line == "right" || line == "WRONG" || line.rfind("right in ", 0) == 0)
      line = tonedVerdict(line);
    for (const char* word : {"right ", "wrong ", "cannot say"})
      if (line.size() > kVerdict && line.compare(0, 2, "  ") == 0 && line[kVerdict - 1] == ' ' &&
          line.compare(kVerdict, std::strlen(word), word) == 0)
        line = line.substr(0, kVerdict) + tonedVerdict(line.substr(kVerdict, kWidth)) +
               line.substr(std::min(line.size(), kVerdict + kWidth));
  }
  return out;
}

}  // namespace dynwitness::cli
