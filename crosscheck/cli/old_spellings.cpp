// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/old_spellings.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/standard_files.hpp"

namespace dynwitness::cli {
namespace {

/// Of version 0.1.0.
struct OldSpelling {
  std::string old, now;
  std::vector<std::string> commands;
};

const std::vector<OldSpelling>& oldSpellings() {
  static const std::vector<OldSpelling> all = {
      {"--states",
       "--random",
       {"chart", "crosscheck", "golden", "parameters", "readers", "rotors", "same"}},
      {"--report", "--output", {"audit", "crosscheck"}},
      {"--joints", "--most-joints", {"crosscheck"}},
      {"--joints", "--joint-impulses", {"impulse"}},
      {"--jobs", "--processes", {"grade", "museum"}},
      {"--damping", "--friction", {"action"}},
      {"--all", "--all-links", {"readers"}},
      {"--all", "--all-scenes", {"golden"}},
      {"--state", "--q", {"action", "geometry", "impedance", "impulse", "linearize", "sweep"}},
      {"--velocity", "--qd", {"action", "geometry", "impulse"}},
      {"--rates", "--qd", {"linearize", "sweep"}},
      {"--accelerations", "--qdd", {"sweep"}},
  };
  return all;
}

/// Mechanisms were what crosscheck drew at random, and of states it had a number: beside one of the
/// old names --random is the old one, too.
const OldSpelling* oldRandom(const std::vector<std::string>& words) {
  static const OldSpelling random = {"--random", "--mechanisms", {"crosscheck"}};
  for (const std::string& word : words)
    if (words[0] == "crosscheck" && (optionOf(word) == "--states" || optionOf(word) == "--joints"))
      return &random;
  return nullptr;
}

}  // namespace

std::vector<std::string> inTodaysSpelling(std::vector<std::string> words) {
  std::vector<OldSpelling> spellings = oldSpellings();
  if (const OldSpelling* random = oldRandom(words)) spellings.insert(spellings.begin(), *random);
  std::set<std::string> told;
  for (std::size_t k = 1; k < words.size() && words[k] != "--"; ++k) {
    const std::string name = optionOf(words[k]);
    for (const OldSpelling& spelling : spellings) {
      const auto& commands = spelling.commands;
      if (name != spelling.old ||
          std::find(commands.begin(), commands.end(), words[0]) == commands.end())
        continue;
      words[k].replace(0, name.size(), spelling.now);
      if (told.insert(name).second)
        tell(
            fmt::format("dynwitness {}: {} is called {} now; the old name goes with the next "
                        "release\n",
                        words[0], spelling.old, spelling.now));
      break;
    }
  }
  return words;
}

}  // namespace dynwitness::cli
