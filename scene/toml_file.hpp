// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers of TOML files have in common. Not installed: no other header includes toml++.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "scene/error.hpp"

namespace dynwitness::scene {

/// The text without a byte order mark at its start.
std::string withoutMark(const std::string& text);

/// Whether there is such a file, and it is TOML by its name.
bool isTomlFile(const std::filesystem::path& file);

/// @throws InputError  it is not TOML, or nested more deeply than any file of ours needs
toml::table parsedToml(const std::string& text, const std::string& file);

/// Looks into the tables of one file, and says by file and line what is wrong with them.
class TomlFile {
 public:
  explicit TomlFile(std::string file) : file_(std::move(file)) {}

 protected:
  using Keys = std::vector<std::string_view>;

  SourceLocation where(const toml::source_region& region) const {
    return {file_, static_cast<int>(region.begin.line)};
  }
  SourceLocation where(const toml::node& node) const { return where(node.source()); }

  [[noreturn]] void wrongType(const toml::node& node, const std::string& what,
                              const std::string& allowed) const;
  void checkKeys(const toml::table& table, const std::string& what, const Keys& allowed) const;
  const toml::table& asTable(const toml::node& node, const std::string& what) const;
  /// The tables of [[key]]; none when the key is absent.
  std::vector<const toml::table*> tables(const toml::table& top, const std::string& key) const;
  std::string string(const toml::node& node, const std::string& what) const;
  std::string optionalString(const toml::table& table, const std::string& key) const;
  const toml::node& required(const toml::table& table, const std::string& what,
                             const std::string& key, const std::string& allowed) const;

  std::string file_;
};

}  // namespace dynwitness::scene
