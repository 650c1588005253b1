// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_words.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace dynwitness::crosscheck::engine {
namespace {

/// A value as it came, short enough for a sentence.
std::string shown(const Json& value) {
  constexpr std::size_t kShown = 80;
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kShown) text = text.substr(0, kShown) + "...";
  return text;
}

/// Whether a word stands where a number might.
bool holdsWord(const std::string& line, const std::string& word) {
  const std::string before = "[:, -", after = "],} ";
  for (std::size_t at = line.find(word, 1); at != std::string::npos; at = line.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if (end < line.size() && before.find(line[at - 1]) != std::string::npos &&
        after.find(line[end]) != std::string::npos)
      return true;
  }
  return false;
}

}  // namespace

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "nothing" : text;
}

std::string plain(std::string text) {
  constexpr std::size_t kMost = 300;
  if (text.size() > kMost) text = text.substr(0, kMost) + "...";
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~') c = '?';
  return text;
}

void expected(const std::string& where, const std::string& what, const Json& came) {
  throw std::runtime_error(where + ": expected " + what + ", got " + shown(came));
}

std::vector<std::string> words(const Json& from, const char* key) {
  std::vector<std::string> out;
  const Json& list = from.at(key);
  if (!list.is_array()) expected(key, "a list of names", list);
  for (const Json& word : list) {
    if (!word.is_string()) expected(key, "a list of names", list);
    out.push_back(word.get<std::string>());
  }
  return out;
}

std::string textOr(const Json& from, const char* key, const std::string& otherwise) {
  const auto at = from.find(key);
  if (at == from.end()) return otherwise;
  if (!at->is_string()) expected(key, "text", *at);
  return at->get<std::string>();
}

Json parsed(const std::string& line) {
  constexpr int kDeepest = 8;  // what is nested more deeply is left out: nothing of ours is
  Json out = Json::parse(
      line, [](int depth, Json::parse_event_t, Json&) { return depth <= kDeepest; }, false);
  if (out.is_object()) return out;
  const std::string start = plain(line.substr(0, 80));
  for (const char* word : {"NaN", "nan", "Infinity", "inf"})
    if (out.is_discarded() && holdsWord(line, word))
      throw std::runtime_error(fmt::format(
          "expected numbers, got {}, which JSON has not: give a text with the reason in place of "
          "a quantity that has no value, in '{}'",
          word, start));
  throw std::runtime_error(fmt::format("expected a JSON object on one line, got '{}'", start));
}

double number(const Json& from, const char* key, const std::string& where) {
  const auto at = from.find(key);
  if (at == from.end() || !at->is_number())
    expected(where + " " + key, "a number", at == from.end() ? Json("none") : *at);
  return at->get<double>();
}

Eigen::Vector3d three(const Json& from, const std::string& where) {
  if (!from.is_array() || from.size() != 3 ||
      !std::all_of(from.begin(), from.end(), [](const Json& x) { return x.is_number(); }))
    expected(where, "three numbers", from);
  return {from[0].get<double>(), from[1].get<double>(), from[2].get<double>()};
}

}  // namespace dynwitness::crosscheck::engine
