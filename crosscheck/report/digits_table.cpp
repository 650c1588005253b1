// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/digits_table.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Markdown reads a bar as the end of a cell.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : oneLine(text)) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

std::string column(const DigitsResult& digits) {
  return digits.scalar == Scalar::kDouble ? digits.witness
                                          : digits.witness + ", " + name(digits.scalar);
}

}  // namespace

std::string digitsTable(const CrosscheckResult& result, const Environment& environment) {
  std::string text = fmt::format(
      "# Correct decimal digits\n\n"
      "Counted against the certified truth, `-log10(largest error / largest entry)`: the fewest "
      "over {} "
      "states a scene (seed {}), their median in brackets. In double where nothing else is said. "
      "A dash: "
      "not answered, or the quantity is 0.\n\n"
      "Written by `{}` as `digits.md` of its report, dynwitness {}",
      result.states, result.seed, cell(result.command), cell(environment.version));
  for (const Environment::Library& library : environment.libraries)
    text += fmt::format(", {} {}", cell(library.name), cell(library.version));
  text += fmt::format("; {}.\n", cell(environment.compiler));

  std::vector<std::string> quantities;
  for (const SceneResult& scene : result.scenes)
    for (const DigitsResult& digits : scene.digits) addOnce(quantities, digits.quantity);
  for (const std::string& quantity : quantities) {
    std::vector<std::string> columns, other_scalars;
    for (const SceneResult& scene : result.scenes)
      for (const DigitsResult& digits : scene.digits)
        if (digits.quantity == quantity)
          addOnce(digits.scalar == Scalar::kDouble ? columns : other_scalars, column(digits));
    columns.insert(columns.end(), other_scalars.begin(), other_scalars.end());
    text += fmt::format("\n## {}\n\n| scene |", cell(quantity));
    std::string rule = "\n|---|";
    for (const std::string& name : columns) {
      text += " " + cell(name) + " |";
      rule += "---:|";
    }
    text += rule + "\n";
    for (const SceneResult& scene : result.scenes) {
      std::map<std::string, std::string> cells;
      for (const DigitsResult& digits : scene.digits)
        if (digits.quantity == quantity && digits.worst)
          cells[column(digits)] = fmt::format("{:.1f} ({:.1f})", *digits.worst, *digits.median);
      text += "| " + cell(scene.name) + " |";
      for (const std::string& name : columns)
        text += cells.count(name) > 0 ? " " + cells[name] + " |" : " – |";
      text += "\n";
    }
  }
  return text;
}

}  // namespace dynwitness::crosscheck
