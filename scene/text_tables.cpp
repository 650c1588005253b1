// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/text_tables.hpp"

#include <sstream>

#include "scene/toml_file.hpp"

namespace dynwitness::scene {
namespace {

class TextTablesReader : TomlFile {
 public:
  using TomlFile::TomlFile;

  std::map<std::string, std::vector<TextTable>> read(
      const toml::table& top, const std::map<std::string, TextTableKeys>& allowed) const {
    Keys names;
    for (const auto& [name, keys] : allowed) names.push_back(name);
    checkKeys(top, "file", names);
    std::map<std::string, std::vector<TextTable>> out;
    for (const auto& [name, keys] : allowed) {
      if (keys.once) {
        const toml::node& node = required(top, "file", name, "a table [" + name + "]");
        out[name].push_back(readTable(asTable(node, name), name, keys));
      } else {
        for (const toml::table* table : tables(top, name))
          out[name].push_back(readTable(*table, name, keys));
      }
    }
    return out;
  }

 private:
  /// A string that says something, its words one space apart.
  std::string words(const toml::node& node, const std::string& what) const {
    std::istringstream stream(string(node, what));
    std::string all;
    for (std::string word; stream >> word;) all += (all.empty() ? "" : " ") + word;
    if (all.empty()) throw InputError(where(node), what + ": an empty string, allowed: a text");
    return all;
  }

  std::vector<std::string> list(const toml::node& node, const std::string& what) const {
    if (!node.is_array()) wrongType(node, what, "an array of strings");
    std::vector<std::string> all;
    for (const toml::node& element : *node.as_array()) all.push_back(words(element, what));
    return all;
  }

  TextTable readTable(const toml::table& table, const std::string& name,
                      const TextTableKeys& keys) const {
    Keys every = keys.required;
    for (const auto* more : {&keys.optional, &keys.lists, &keys.flags})
      every.insert(every.end(), more->begin(), more->end());
    checkKeys(table, name, every);
    TextTable out{where(table), {}, {}, {}};
    const auto readText = [&](const std::string& key, const toml::node& node) {
      out.texts[key] = {words(node, name + ": " + key), where(node)};
    };
    for (const std::string_view key : keys.required)
      readText(std::string(key), required(table, name, std::string(key), "a text"));
    for (const std::string_view key : keys.optional)
      if (const toml::node* node = table.get(key)) readText(std::string(key), *node);
    for (const std::string_view key : keys.lists)
      if (const toml::node* node = table.get(key))
        out.lists[std::string(key)] = list(*node, name + ": " + std::string(key));
    for (const std::string_view key : keys.flags)
      if (const toml::node* node = table.get(key)) {
        if (!node->is_boolean()) wrongType(*node, name + ": " + std::string(key), "true or false");
        if (node->as_boolean()->get()) out.flags.emplace(key);
      }
    return out;
  }
};

}  // namespace

std::map<std::string, std::vector<TextTable>> readTextTables(
    const std::string& text, const std::string& file,
    const std::map<std::string, TextTableKeys>& allowed) {
  return TextTablesReader(file).read(parsedToml(withoutMark(text), file), allowed);
}

}  // namespace dynwitness::scene
