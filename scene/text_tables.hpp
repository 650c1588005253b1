// SPDX-License-Identifier: GPL-3.0-or-later
// TOML files that people write sentences into: tables of texts, lists of texts and flags.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "scene/error.hpp"

namespace dynwitness::scene {

/// A text as it was meant: its lines joined by spaces. Never empty.
struct Text {
  std::string words;
  SourceLocation where;
};

/// One table of the file. What is optional and left out is not in the maps.
struct TextTable {
  SourceLocation where;
  std::map<std::string, Text> texts;
  std::map<std::string, std::vector<std::string>> lists;
  std::set<std::string> flags;  ///< those that are true
};

/// What a table may hold.
struct TextTableKeys {
  std::vector<std::string_view> required, optional, lists, flags;
  bool once = false;  ///< [name] and not [[name]]: it must be there
};

/** Reads a whole file of such tables.
    @param allowed  by name of the table
    @return  by the same names, in the order of the file
    @throws InputError  not TOML, a table or key that is not allowed, one that is missing, a value
    of another type, an empty text */
std::map<std::string, std::vector<TextTable>> readTextTables(
    const std::string& text, const std::string& file,
    const std::map<std::string, TextTableKeys>& allowed);

}  // namespace dynwitness::scene
