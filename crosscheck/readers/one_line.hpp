// SPDX-License-Identifier: GPL-3.0-or-later
// What engines say, for a sentence of ours.
#pragma once

#include <string>

namespace dynwitness {

/// One line, without the codes that colour it.
inline std::string inOneLine(const std::string& text) {
  std::string out;
  bool in_code = false;
  for (const char c : text) {
    if (c == '\x1b') in_code = true;
    if (!in_code) out += c == '\n' ? ' ' : c;
    if (c == 'm') in_code = false;
  }
  return out;
}

}  // namespace dynwitness
