// SPDX-License-Identifier: GPL-3.0-or-later
// Words for a shell.
#pragma once

#include <string>

namespace dynwitness::crosscheck {

/// In quotes, so that a shell takes it for one word.
inline std::string shellWord(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

}  // namespace dynwitness::crosscheck
