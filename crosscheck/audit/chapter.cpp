// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/audit/chapter.hpp"

#include <algorithm>
#include <set>

#include "scene/scene.hpp"
#include "scene/text_file.hpp"
#include "scene/text_tables.hpp"

namespace dynwitness::audit {
namespace {

using scene::InputError;
using scene::TextTable;

bool isDigits(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// "7.1.2" as numbers, for the order of the chapter; none when it is no section's number.
std::vector<int> sectionNumbers(const std::string& section) {
  std::vector<int> numbers;
  for (std::size_t at = 0; at <= section.size();) {
    const std::size_t end = std::min(section.find('.', at), section.size());
    const std::string part = section.substr(at, end - at);
    if (!isDigits(part) || part.size() > 3) return {};
    numbers.push_back(std::stoi(part));
    at = end + 1;
  }
  return numbers;
}

std::string textOf(const TextTable& table, const std::string& key) {
  const auto found = table.texts.find(key);
  return found == table.texts.end() ? "" : found->second.words;
}

Statement readStatement(const TextTable& table) {
  for (const auto& [key, text] : table.texts)
    if (std::count(text.words.begin(), text.words.end(), '`') % 2 != 0)
      throw InputError(text.where,
                       "statement: " + key + ": an odd number of backticks, allowed: pairs");
  const auto text = [&](const char* key) { return textOf(table, key); };
  Statement out;
  out.where = table.where;
  out.id = text("id");
  out.section = text("section");
  out.title = text("title");
  out.printed = text("printed");
  out.corrected = text("corrected");
  out.condition = text("condition");
  out.why = text("why");
  out.implemented_in = text("implemented_in");
  out.left_open = table.flags.count("left_open") != 0;
  out.not_printed = table.flags.count("not_printed") != 0;
  out.numbers_caption = text("numbers_caption");
  if (const auto head = table.lists.find("numbers_head"); head != table.lists.end())
    out.numbers_head = head->second;
  return out;
}

/// @param last  the section of the statement before this
void requireInOrder(const Statement& statement, const Chapter& chapter, std::vector<int>* last) {
  const std::vector<int> section = sectionNumbers(statement.section);
  const auto refuse = [&](const std::string& what) {
    throw InputError(statement.where, "statement \"" + statement.id + "\": section \"" +
                                          statement.section + "\"" + what);
  };
  if (section.empty() || section[0] < 1 || section[0] > static_cast<int>(chapter.sections.size()))
    refuse(", allowed: 1 to " + std::to_string(chapter.sections.size()) + ", or a part: 5.2");
  if (section < *last) refuse(" after a later one, allowed: the order of the chapter");
  *last = section;
}

}  // namespace

bool Statement::isEquation() const {
  return !left_open && id.compare(0, 2, "eq") == 0 && isDigits(id.substr(2));
}

Chapter readChapter(const std::string& text, const std::string& file) {
  const auto tables = scene::readTextTables(
      text, file,
      {{"chapter", {{"author", "title", "year"}, {}, {"criterion", "sections"}, {}, true}},
       {"statement",
        {{"id", "section", "title", "printed", "why", "implemented_in"},
         {"corrected", "condition", "numbers_caption"},
         {"numbers_head"},
         {"left_open", "not_printed"}}}});
  const TextTable& head = tables.at("chapter").front();
  Chapter chapter{file, textOf(head, "author"), textOf(head, "title"), textOf(head, "year"), {}, {},
                  {}};
  const auto require = [&](const char* key, const char* what) {
    if (head.lists.count(key) == 0)
      throw InputError(head.where, std::string("chapter: has no ") + key + ", allowed: " + what);
  };
  require("criterion", "an array of rules");
  chapter.criterion = head.lists.at("criterion");
  require("sections", "an array of their titles");
  chapter.sections = head.lists.at("sections");
  std::set<std::string> ids;
  std::vector<int> section;
  const auto statements = tables.find("statement");
  if (statements == tables.end()) return chapter;
  for (const TextTable& table : statements->second) {
    chapter.statements.push_back(readStatement(table));
    const Statement& statement = chapter.statements.back();
    if (!ids.insert(statement.id).second)
      throw InputError(statement.where,
                       "statement \"" + statement.id + "\": a second one, allowed: each id once");
    requireInOrder(statement, chapter, &section);
  }
  return chapter;
}

Chapter bundledChapter() {
  const std::filesystem::path file = scene::dataFolder() / "audit" / "chapter.toml";
  return readChapter(scene::readTextFile(file, "the sentences of the audit, a TOML file"),
                     file.string());
}

}  // namespace dynwitness::audit
