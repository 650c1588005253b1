// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/nearest_name.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace dynwitness::scene {
namespace {

std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, corner + (a[i] == b[j] ? 0 : 1)});
      corner = above;
    }
  }
  return row.back();
}

std::string small(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return word;
}

std::string sorted(std::string word) {
  std::sort(word.begin(), word.end());
  return word;
}

}  // namespace

std::string nearestName(const std::string& word, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (small(name) == small(word)) return name;
  if (word.size() >= 3)
    for (const std::string& name : names)
      if (sorted(name) == sorted(word)) return name;
  if (word.size() >= 3)
    for (const std::string& name : names)
      if (name.compare(0, word.size(), word) == 0) return name;
  std::string nearest;
  if (word.size() >= 3)
    for (const std::string& name : names)
      if (name.find(word) != std::string::npos && (nearest.empty() || name.size() < nearest.size()))
        nearest = name;
  if (!nearest.empty()) return nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& name : names)
    // with a letter in common, or anything of one letter would be near to all such
    if (const std::size_t letters = distance(word, name);
        letters < least && letters < std::max(word.size(), name.size())) {
      least = letters;
      nearest = name;
    }
  return nearest;
}

std::string didYouMean(const std::string& word, const std::vector<std::string>& names) {
  const std::string nearest = nearestName(word, names);
  return nearest.empty() ? "" : " (did you mean " + nearest + "?)";
}

}  // namespace dynwitness::scene
