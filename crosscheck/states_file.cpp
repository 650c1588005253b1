// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/states_file.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <string>

#include <fmt/format.h>

#include "scene/error.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::InputError;
using scene::SourceLocation;

constexpr const char* kGroups[] = {"q", "qd", "qdd", "tau"};

std::string trimmed(const std::string& cell) {
  const char* blanks = " \t\r";
  const std::size_t begin = cell.find_first_not_of(blanks);
  if (begin == std::string::npos) return "";
  return cell.substr(begin, cell.find_last_not_of(blanks) - begin + 1);
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::size_t begin = line.rfind("\xEF\xBB\xBF", 0) == 0 ? 3 : 0;  // a byte order mark is no name
  for (;;) {
    const std::size_t comma = line.find(',', begin);
    cells.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string::npos) return cells;
    begin = comma + 1;
  }
}

double number(const std::string& cell, const std::string& column, const SourceLocation& where) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    throw InputError(where, fmt::format("{} is '{}', allowed: a finite number", column, cell));
  return value;
}

void requireQuaternions(const scene::Mechanism& mechanism, const scene::State<double>& state,
                        const SourceLocation& where) {
  int slot = 0;
  for (const scene::Link& link : mechanism.links) {
    const std::vector<scene::SlotKind>& slots = scene::positionSlots(link.joint.kind);
    slot += static_cast<int>(slots.size());
    if (slots.empty() || slots.back() != scene::SlotKind::kQuaternion) continue;
    double size = 0;
    for (int k = slot - 4; k < slot; ++k) size += std::abs(state.x[k].q);
    if (size == 0)
      throw InputError(where, fmt::format("q{} to q{} are the quaternion of joint '{}' and all zero, "
                                          "allowed: any other (1, 0, 0, 0 is no turn)",
                                          slot - 3, slot, link.joint.name));
  }
}

}  // namespace

std::vector<scene::State<double>> readStates(const std::filesystem::path& file,
                                             const scene::Mechanism& mechanism) {
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file)) throw InputError({file.string()}, "cannot be read");
  const std::string allowed =
      fmt::format("q1..q{1}, qd1..qd{0}, and qdd1..qdd{0} or tau1..tau{0}", mechanism.dof(),
                  mechanism.positions());
  const auto count = [&](const std::string& group) {
    return group == "q" ? mechanism.positions() : mechanism.dof();
  };

  std::vector<std::string> columns;
  std::map<std::string, int> at;  // column name -> place in the row
  std::vector<scene::State<double>> states;
  std::string line;
  SourceLocation where{file.string(), 0};
  while (std::getline(in, line)) {
    ++where.line;
    const std::vector<std::string> cells = split(line);
    if (cells[0].rfind('#', 0) == 0 || (cells.size() == 1 && cells[0].empty())) continue;

    if (columns.empty()) {
      columns = cells;
      std::map<std::string, int> known;
      for (const char* group : kGroups)
        for (int i = 1; i <= count(group); ++i) known[group + std::to_string(i)] = 0;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        if (known.count(columns[k]) == 0)
          throw InputError(where, fmt::format("column '{}' is unknown, allowed: {}", columns[k], allowed));
        if (!at.emplace(columns[k], static_cast<int>(k)).second)
          throw InputError(where, fmt::format("column '{}' stands twice", columns[k]));
      }
      for (const std::string group : kGroups) {
        int present = 0;
        const int n = count(group);
        for (int i = 1; i <= n; ++i) present += at.count(group + std::to_string(i)) > 0 ? 1 : 0;
        if (present == n || (present == 0 && group != "q")) continue;
        for (int i = 1; i <= n; ++i)
          if (at.count(group + std::to_string(i)) == 0)
            throw InputError(where, fmt::format("column '{}{}' is missing, expected {}", group, i, allowed));
      }
      continue;
    }

    if (cells.size() != columns.size())
      throw InputError(where, fmt::format("{} entries, the header names {}", cells.size(), columns.size()));
    const auto entry = [&](const std::string& group, int i) {
      const auto found = at.find(group + std::to_string(i + 1));
      return found == at.end() ? 0.0 : number(cells[found->second], found->first, where);
    };
    scene::State<double> state;
    for (int i = 0; i < mechanism.positions(); ++i)
      state.x.push_back(scene::jointPosition(entry("q", i)));
    requireQuaternions(mechanism, state, where);
    for (int i = 0; i < mechanism.dof(); ++i) {
      state.qd.push_back(entry("qd", i));
      state.qdd.push_back(entry("qdd", i));
      state.tau.push_back(entry("tau", i));
    }
    states.push_back(state);
  }
  if (columns.empty()) throw InputError(where, "no header, expected " + allowed);
  return states;
}

}  // namespace dynwitness::crosscheck
