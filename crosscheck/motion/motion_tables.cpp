// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/motion_tables.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tuple>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scene/numbers.hpp"

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
    if (!given.is_string() && given.contains("scale"))
      column.scale = scene::RealNumbers<double>(mechanism)(number(given.at("scale")));
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
  return column;
}

MotionTable readTable(const json& given, const scene::Mechanism& mechanism, const fs::path& file) {
  MotionTable table;
  table.title = given.at("title").get<std::string>();
  table.source = given.at("source").get<std::string>();
  table.absolute = given.value("absolute", 0.0);
  table.relative = given.value("relative", 0.0);
  table.step_error = given.value("step_error", 0.0);
  if (!(table.absolute + table.relative > 0)) fail(file, "no limit, allowed: absolute or relative");
  for (const json& column : given.at("columns"))
    table.columns.push_back(readColumn(column, mechanism, file));
  for (const json& row : given.at("rows")) {
    std::vector<double> values = row.get<std::vector<double>>();
    if (values.size() != table.columns.size() + 1)
      fail(file, fmt::format("a row of {} numbers, allowed: a time and {} values", values.size(),
                             table.columns.size()));
    table.rows.push_back({values[0], {values.begin() + 1, values.end()}});
  }
  if (table.rows.empty() || table.columns.empty()) fail(file, "no rows or no columns");
  return table;
}

/// Bundled scenes and families are known by their files: the user's own may have the same name.
bool isAbout(const std::string& name, const scene::Scene& scene) {
  std::error_code error;
  const fs::path bundled = scene::dataFolder() / "scenes" / (name + ".toml");
  return fs::exists(bundled, error) ? fs::equivalent(bundled, scene.file, error)
                                    : scene.file == fs::path(name);
}

}  // namespace

std::vector<MotionTable> motionTables(const scene::Scene& scene) {
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
      if (isAbout(given.at("scene").get<std::string>(), scene))
        tables.push_back(readTable(given, scene.mechanism, file));
    } catch (const json::exception& problem) {
      fail(file, problem.what());
    }
  }
  return tables;
}

MotionVerdict compareMotion(const scene::Scene& scene, const Simulation& simulation,
                            const MotionTable& table) {
  std::vector<std::vector<std::array<double, 3>>> paths;  // one a column; empty for coordinates
  for (const MotionTable::Column& column : table.columns) {
    paths.emplace_back();
    if (column.of == MotionTable::Column::Of::kPoint)
      paths.back() = pathOf(scene, simulation, column.point);
  }
  MotionVerdict verdict;
  for (std::size_t k = 0; k < simulation.points.size(); ++k) {
    const Simulation::Point& point = simulation.points[k];
    const auto row = std::find_if(table.rows.begin(), table.rows.end(),
                                  [&](const MotionTable::Row& r) { return r.time == point.time; });
    if (row == table.rows.end()) continue;
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const MotionTable::Column& column = table.columns[i];
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
        return paths[i][k][column.axis];
      };
      const double value = column.scale * ours();
      const double error = std::abs(value - row->values[i]);
      const double ratio = error / (table.absolute + table.relative * std::abs(row->values[i]));
      ++verdict.values;
      if (!(error <= verdict.worst)) verdict.worst = error;  // NaN is the worst
      if (ratio <= verdict.ratio) continue;
      verdict.ratio = ratio;
      verdict.worst_time = point.time;
    }
  }
  return verdict;
}

}  // namespace dynwitness::crosscheck
