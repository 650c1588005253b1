// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/motion_tables.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <tuple>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/motion/state_gap.hpp"
#include "scene/numbers.hpp"
#include "scene/units.hpp"

namespace dynwitness::crosscheck {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw scene::InputError({file.string(), 0}, what);
}

scene::Number number(const json& value) {
  return scene::Number::parse(value.is_string() ? value.get<std::string>() : value.dump());
}

/// The units of all q, or of all qd.
std::vector<std::string> unitsOf(MotionTable::Column::Of of, const scene::Mechanism& mechanism) {
  std::vector<std::string> units;
  for (const scene::Link& link : mechanism.links) {
    const scene::JointKind kind = link.joint.kind;
    if (link.joint.mimic) continue;  // its positions and rates are no coordinates
    if (of == MotionTable::Column::Of::kPosition)
      for (const scene::SlotKind slot : scene::positionSlots(kind))
        units.emplace_back(scene::unitOf(slot));
    else
      for (int i = 0; i < link.joint.ownRates(); ++i)
        units.emplace_back(scene::slides(kind, static_cast<std::size_t>(i)) ? "m/s" : "rad/s");
  }
  return units;
}

MotionTable::Column readColumn(const json& given, const scene::Mechanism& mechanism,
                               const fs::path& file) {
  MotionTable::Column column;
  using Of = MotionTable::Column::Of;
  if (given.is_string() || given.contains("of")) {
    const std::string name =
        given.is_string() ? given.get<std::string>() : given.at("of").get<std::string>();
    int multipliers = 0;
    for (const scene::Closure& closure : mechanism.closures)
      multipliers += scene::equationCount(closure.kind);
    const std::tuple<const char*, Of, int> kinds[] = {{"q", Of::kPosition, mechanism.positions()},
                                                      {"qd", Of::kRate, mechanism.dof()},
                                                      {"lambda", Of::kMultiplier, multipliers}};
    std::string allowed;
    for (const auto& [letter, of, count] : kinds) {
      for (int i = 0; i < count; ++i)
        if (name == fmt::format("{}{}", letter, i + 1)) column.of = of, column.index = i;
      if (count > 0)
        allowed += fmt::format("{}{}1 to {}{}", allowed.empty() ? "" : ", ", letter, letter, count);
    }
    if (column.index < 0) fail(file, fmt::format("column '{}', allowed: {}", name, allowed));
    column.name = name;
    if (column.of != Of::kMultiplier)
      column.unit = unitsOf(column.of, mechanism).at(static_cast<std::size_t>(column.index));
    if (!given.is_string() && given.contains("scale")) {
      const scene::Number scale = number(given.at("scale"));
      column.scale = scene::RealNumbers<double>(mechanism)(scale);
      column.name = fmt::format("{} {}", scale.text(), name);
      column.unit.clear();
    }
    return column;
  }
  const std::string link = given.at("link").get<std::string>();
  const auto found = std::find_if(mechanism.links.begin(), mechanism.links.end(),
                                  [&](const scene::Link& l) { return l.name == link; });
  if (found == mechanism.links.end()) fail(file, "'" + link + "' is not a link of the scene");
  column.point.link = static_cast<int>(found - mechanism.links.begin());
  const json& at = given.at("at");
  column.point.xyz = {number(at.at(0)), number(at.at(1)), number(at.at(2))};
  const std::string axis = given.at("axis").get<std::string>();
  if (axis != "x" && axis != "y" && axis != "z")
    fail(file, "axis '" + axis + "', allowed: x, y, z");
  column.axis = axis[0] - 'x';
  column.unit = "m";
  column.name = fmt::format("{} ({}, {}, {}) {}", link, column.point.xyz[0].text(),
                            column.point.xyz[1].text(), column.point.xyz[2].text(), axis);
  return column;
}

MotionTable readTable(const json& given, const scene::Scene& scene, const fs::path& file) {
  MotionTable table;
  table.scene = scene;
  table.title = given.at("title").get<std::string>();
  table.source = given.at("source").get<std::string>();
  table.own = given.value("own", "");
  table.note = given.value("note", "");
  table.absolute = given.value("absolute", 0.0);
  table.relative = given.value("relative", 0.0);
  table.step_error = given.value("step_error", 0.0);
  if (!(table.absolute + table.relative > 0)) fail(file, "no limit, allowed: absolute or relative");
  for (const json& column : given.at("columns"))
    table.columns.push_back(readColumn(column, scene.mechanism, file));
  for (const json& row : given.at("rows")) {
    std::vector<double> values = row.get<std::vector<double>>();
    if (values.size() != table.columns.size() + 1)
      fail(file, fmt::format("a row of {} numbers, allowed: a time and {} values", values.size(),
                             table.columns.size()));
    if (!table.rows.empty() && !(values[0] > table.rows.back().time))
      fail(file, fmt::format("a row at t = {} s after one at {} s, allowed: rising times",
                             values[0], table.rows.back().time));
    table.rows.push_back({values[0], {values.begin() + 1, values.end()}});
  }
  if (table.rows.empty() || table.columns.empty()) fail(file, "no rows or no columns");
  return table;
}

bool isFile(const fs::path& file, const scene::Scene& scene) {
  std::error_code error;
  return fs::exists(file, error) && fs::equivalent(file, scene.file, error);
}

/// Bundled scenes and families are known by their files: the user's own may have the same name.
bool isAbout(const std::string& name, const scene::Scene& scene) {
  const fs::path bundled = scene::dataFolder() / "scenes" / (name + ".toml");
  std::error_code error;
  return fs::exists(bundled, error) ? isFile(bundled, scene) : scene.file == fs::path(name);
}

/// What a table has to do with a scene.
enum class Standing { kMoves, kIsReportedIn };

std::vector<MotionTable> tablesOf(const scene::Scene& scene, Standing standing) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry :
       fs::directory_iterator(scene::dataFolder() / "reference" / "motion", error))
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<MotionTable> tables;
  for (const fs::path& file : files) {
    std::ifstream in(file);
    if (!in) fail(file, "cannot be read");
    try {
      const json given = json::parse(in);
      const bool is_named = isAbout(given.at("scene").get<std::string>(), scene);
      if (!given.contains("scene_file")) {
        if (is_named) tables.push_back(readTable(given, scene, file));
        continue;
      }
      const fs::path own = file.parent_path() / given.at("scene_file").get<std::string>();
      if (standing == Standing::kMoves ? isFile(own, scene) : is_named)
        tables.push_back(readTable(given, scene::readScene(own), file));
    } catch (const json::exception& problem) {
      fail(file, problem.what());
    }
  }
  return tables;
}

/// NaN is the worst of all.
bool isWorse(double a, double b) {
  return !std::isnan(b) && !(a <= b);
}

}  // namespace

double MotionTable::duration() const {
  return rows.back().time;
}

std::vector<MotionTable> motionTables(const scene::Scene& scene) {
  return tablesOf(scene, Standing::kMoves);
}
std::vector<MotionTable> reportedMotionTables(const scene::Scene& scene) {
  return tablesOf(scene, Standing::kIsReportedIn);
}

double MotionVerdict::Entry::difference() const {
  return std::abs(simulated - printed);
}
double MotionVerdict::Entry::digits() const {
  constexpr double kAll = std::numeric_limits<double>::max_digits10;
  return std::clamp(-std::log10(difference() / largest), 0.0, kAll);
}

MotionVerdict compareMotion(const scene::Scene& scene, const Simulation& simulation,
                            const MotionTable& table) {
  MotionVerdict verdict;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const MotionTable::Column& column = table.columns[i];
    std::vector<std::array<double, 3>> path;
    if (column.of == MotionTable::Column::Of::kPoint)
      path = pathOf(scene, simulation, column.point);
    MotionVerdict::Entry closest;
    closest.column = static_cast<int>(i);
    bool has_values = false;
    for (const MotionTable::Row& row : table.rows)
      closest.largest = std::max(closest.largest, std::abs(row.values[i]));
    for (std::size_t k = 0; k < simulation.points.size(); ++k) {
      const Simulation::Point& point = simulation.points[k];
      const auto row =
          std::find_if(table.rows.begin(), table.rows.end(),
                       [&](const MotionTable::Row& r) { return r.time == point.time; });
      if (row == table.rows.end()) continue;
      const auto ours = [&]() -> double {
        switch (column.of) {
          case MotionTable::Column::Of::kPosition:
            return point.q[column.index];
          case MotionTable::Column::Of::kRate:
            return point.qd[column.index];
          case MotionTable::Column::Of::kMultiplier:
            return point.lambda[column.index];
          case MotionTable::Column::Of::kPoint:
            break;
        }
        return path[k][column.axis];
      };
      MotionVerdict::Entry entry = closest;
      entry.time = point.time;
      entry.printed = row->values[i];
      entry.simulated = column.scale * ours();
      entry.limit = table.absolute + table.relative * std::abs(entry.printed);
      ++verdict.values;
      keepWorse(&verdict.worst, entry.difference());
      if (!has_values || isWorse(entry.ratio(), closest.ratio())) closest = entry;
      has_values = true;
    }
    if (!has_values) continue;
    verdict.entries.push_back(closest);
    if (!isWorse(closest.ratio(), verdict.ratio)) continue;
    verdict.ratio = closest.ratio();
    verdict.worst_time = closest.time;
  }
  return verdict;
}

SimulateOptions optionsFor(const MotionTable& table) {
  SimulateOptions options;
  options.duration = table.duration();
  if (table.step_error > 0) options.step_error = std::min(options.step_error, table.step_error);
  for (const MotionTable::Row& row : table.rows) options.more_times.push_back(row.time);
  return options;
}

}  // namespace dynwitness::crosscheck
