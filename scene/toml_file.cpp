// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/toml_file.hpp"

#include <algorithm>
#include <cstring>

#include "scene/faults.hpp"
#include "scene/nearest_name.hpp"

namespace dynwitness::scene {
namespace {

std::string typeName(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

/** @throws InputError on keys of many parts (a.b.c...) and on values deep inside one another.
    toml++ makes a table of each part and takes tables apart by recursion: a key of 10^5 parts ends
    on the stack's end. Deepest allowed is a table header of kMostParts, then kMostDepth tables with
    as many in the key of each. */
void requireShallow(const std::string& text, const std::string& file) {
  constexpr int kMostParts = 16, kMostDepth = 16;  // a scene needs 2 and 4
  int line = 1, parts = 1, depth = 0;
  const auto require = [&](int count, int most, const char* what) {
    if (count > most)
      throw InputError({file, line}, "more than " + std::to_string(most) + " " + what);
  };
  const auto skipTo = [&](std::size_t from, std::string_view end) {
    const std::size_t to = std::min(text.find(end, from), text.size());
    line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(from),
                                        text.begin() + static_cast<std::ptrdiff_t>(to), '\n'));
    return to;
  };
  // past a string that begins at `from`, and past what a backslash makes a part of it
  const auto skipString = [&](std::size_t from) {
    const std::string_view quote = std::string_view(text).substr(from, 1);
    const bool is_long = text.compare(from, 3, std::string(3, quote[0])) == 0;
    const std::string_view end = std::string_view(text).substr(from, is_long ? 3 : 1);
    std::size_t at = from + end.size();
    for (; at < text.size() && text.compare(at, end.size(), end) != 0; ++at) {
      if (text[at] == '\n' && !is_long) return at;
      if (text[at] == '\\' && quote == "\"") ++at;
      if (at < text.size() && text[at] == '\n') ++line;
    }
    at += end.size();
    for (int more = 0;
         is_long && more < 2 && text.compare(at < text.size() ? at : text.size(), 1, quote) == 0;
         ++more)
      ++at;  // up to two quotes may stand before the three that end it
    return at;
  };
  for (std::size_t at = 0; at < text.size();) {
    switch (text[at]) {
      case '#':
        at = skipTo(at, "\n");
        continue;
      case '"':
      case '\'':
        at = skipString(at);
        continue;
      case '.':
        require(++parts, kMostParts, "parts in a key");
        break;
      case '[':
      case '{':
        require(++depth, kMostDepth, "tables and arrays inside one another");
        break;
      case ']':
      case '}':
        depth = std::max(0, depth - 1);
        break;
      case '\n':
        ++line;
        break;
      default:
        break;
    }
    if (std::strchr("=,[]{}\n", text[at]) != nullptr) parts = 1;
    ++at;
  }
}

}  // namespace

std::string withoutMark(const std::string& text) {
  return text.compare(0, 3, "\xEF\xBB\xBF") == 0 ? text.substr(3) : text;  // byte order mark
}

bool isTomlFile(const std::filesystem::path& file) {
  return file.extension() == ".toml" && std::filesystem::exists(file);
}

toml::table parsedToml(const std::string& text, const std::string& file) {
  requireShallow(text, file);
  try {
    return toml::parse(std::string_view(text), std::string_view(file));
  } catch (const toml::parse_error& error) {
    throw InputError({file, static_cast<int>(error.source().begin.line)},
                     "not TOML: " + std::string(error.description()));
  }
}

void TomlFile::wrongType(const toml::node& node, const std::string& what,
                         const std::string& allowed) const {
  throw InputError(where(node), what + ": " + typeName(node) + ", allowed: " + allowed);
}

void TomlFile::checkKeys(const toml::table& table, const std::string& what,
                         const Keys& allowed) const {
  Faults faults;
  for (const auto& [key, value] : table) {
    if (std::find(allowed.begin(), allowed.end(), key.str()) != allowed.end()) continue;
    std::string names;
    for (const std::string_view name : allowed) {
      names += (names.empty() ? "" : ", ") + std::string(name);
    }
    faults.collect([&, &key = key] {
      const std::string read(key.str());
      throw InputError(where(key.source()), what + ": unknown key \"" + read + '"' +
                                                didYouMean(read, {allowed.begin(), allowed.end()}) +
                                                ", allowed: " + names);
    });
  }
  faults.raise();
}

const toml::table& TomlFile::asTable(const toml::node& node, const std::string& what) const {
  if (!node.is_table()) wrongType(node, what, "a table");
  return *node.as_table();
}

std::vector<const toml::table*> TomlFile::tables(const toml::table& top,
                                                 const std::string& key) const {
  std::vector<const toml::table*> result;
  const toml::node* node = top.get(key);
  if (!node) return result;
  const std::string allowed = "[[" + key + "]] tables";
  if (!node->is_array()) wrongType(*node, key, allowed);
  for (const toml::node& element : *node->as_array()) {
    if (!element.is_table()) wrongType(element, key, allowed);
    result.push_back(element.as_table());
  }
  return result;
}

std::string TomlFile::string(const toml::node& node, const std::string& what) const {
  if (!node.is_string()) wrongType(node, what, "a string");
  return node.as_string()->get();
}

std::string TomlFile::optionalString(const toml::table& table, const std::string& key) const {
  const toml::node* node = table.get(key);
  return node ? string(*node, key) : std::string();
}

const toml::node& TomlFile::required(const toml::table& table, const std::string& what,
                                     const std::string& key, const std::string& allowed) const {
  const toml::node* node = table.get(key);
  if (!node) throw InputError(where(table), what + ": has no " + key + ", allowed: " + allowed);
  return *node;
}

}  // namespace dynwitness::scene
