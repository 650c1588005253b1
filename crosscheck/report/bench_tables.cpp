// SPDX-License-Identifier: GPL-3.0-or-later
// The same tables for a terminal and for the report.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/report/bench.hpp"
#include "crosscheck/report/page_parts.hpp"
#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {
namespace {

std::string esc(const std::string& text) {
  return escapeMarkup(text);
}

/// Digits that can be read at a glance: "0.32", "8.30", "14.2", "142".
std::string figure(double x) {
  if (x < 1) return fmt::format("{:.2g}", x);
  if (x >= 10 && x == std::floor(x)) return fmt::format("{:.0f}", x);
  return fmt::format("{:.{}f}", x, x < 10 ? 2 : x < 100 ? 1 : 0);
}
std::string figure(const std::optional<double>& x) {
  return x ? figure(*x) : "-";
}

/// Contenders at one scene: a cell for each of what was timed.
template <typename Cell, std::size_t kCells>
struct SceneTable {
  struct Row {
    std::string label;
    std::array<Cell, kCells> cells;
  };
  std::string scene;
  std::vector<Row> rows;
};

/// Of all scenes where any of `timed` was measured, and the contenders that were.
/// @param cell  of what, scene and contender; its ns is none where that was not measured
template <std::size_t kCells, typename CellOf>
auto sceneTables(const BenchResult& result, const char* const (&timed)[kCells],
                 const CellOf& cell) {
  using Cell = std::invoke_result_t<CellOf, const char*, std::string, std::string>;
  using Table = SceneTable<Cell, kCells>;
  std::vector<Table> tables;
  for (const Measurement& m : result.measured) {
    const bool is_timed =
        m.unit == "ns" && std::find(std::begin(timed), std::end(timed), m.what) != std::end(timed);
    if (!is_timed || std::any_of(tables.begin(), tables.end(),
                                 [&](const Table& t) { return t.scene == m.subject; }))
      continue;
    tables.push_back({m.subject, {}});
    for (const Contender& contender : result.contenders) {
      typename Table::Row row{contender.label, {}};
      for (std::size_t k = 0; k < kCells; ++k)
        row.cells[k] = cell(timed[k], m.subject, contender.name);
      if (std::any_of(row.cells.begin(), row.cells.end(),
                      [](const Cell& c) { return c.ns.has_value(); }))
        tables.back().rows.push_back(std::move(row));
    }
  }
  return tables;
}

/// Of one evaluation.
struct TimeCell {
  std::optional<double> ns, mujoco, simbody;
};
auto timeTables(const BenchResult& result) {
  return sceneTables(result, kTimed,
                     [&](const char* what, const std::string& scene, const std::string& by) {
                       return TimeCell{result.value(what, scene, by, "ns"),
                                       result.timesFaster(kRawMujoco, what, scene, by),
                                       result.timesFaster(kRawSimbody, what, scene, by)};
                     });
}

/// Of one step.
struct StepCell {
  std::optional<double> ns, times_best;
};
auto stepTables(const BenchResult& result) {
  return sceneTables(result, kSteps,
                     [&](const char* what, const std::string& scene, const std::string& by) {
                       return StepCell{result.value(what, scene, by, "ns"),
                                       result.timesFasterThanEngines(what, scene, by)};
                     });
}

/// "1560 k" of what takes so many nanoseconds.
std::string perSecond(const std::optional<double>& ns) {
  return ns ? figure(1e9 / *ns / 1000) + " k" : "-";
}

/// What else was measured, a line a contender: "5.44 ms, 2.48 MB, 1141 operations".
struct OtherNumbers {
  std::string what, subject, label, values;
};
std::vector<OtherNumbers> otherNumbers(const BenchResult& result) {
  std::vector<OtherNumbers> lines;
  for (const Measurement& m : result.measured) {
    // what limits are made of is seen in these
    if (m.isTime() || m.isStep() || m.subject == kMachine || m.unit == kOperationsWithSines ||
        m.unit == kBytesRead || m.unit == kBytesWritten || m.unit == kBytesAtHand)
      continue;
    const std::string label = result.label(m.by),
                      value = fmt::format("{} {}", figure(m.value), m.unit);
    const auto found = std::find_if(lines.begin(), lines.end(), [&](const OtherNumbers& o) {
      return o.what == m.what && o.subject == m.subject && o.label == label;
    });
    if (found == lines.end())
      lines.push_back({m.what, m.subject, label, value});
    else
      found->values += ", " + value;
  }
  return lines;
}

std::string goalName(const BenchResult& result, const Goal& goal) {
  return fmt::format("{}, {}: {}", goal.subject, goal.what, result.label(goal.by));
}
std::string wanted(const Goal& goal) {
  return fmt::format("{} {} {}", goal.at_least ? "at least" : "at most", goal.wanted, goal.unit);
}
std::string verdictWords(const GoalVerdict& verdict) {
  return verdict.measured && !verdict.is_reached ? "MISSED by " + figure(verdict.missed_by) + " %"
                                                 : verdict.word();
}

/// "19.2 ns operations"
std::string limitWords(const GoalVerdict& verdict) {
  return verdict.limit ? fmt::format("{} ns {}", figure(verdict.limit->ns), verdict.limit->of)
                       : "-";
}
std::string timesLimit(const GoalVerdict& verdict) {
  return verdict.limit ? figure(verdict.limit->times) : "-";
}
constexpr const char* kWhatLimitsAre =
    "Limit: operations, sines and cosines among them, or bytes in or out, whichever takes the "
    "machine longer at its best, measured in this run";

/// "31 of 40 goals reached, 7 missed, 2 not measured"
std::string goalsSentence(const BenchResult& result) {
  int reached = 0, missed = 0, unknown = 0;
  for (const Goal& goal : result.goals) {
    const GoalVerdict verdict = judge(result, goal);
    ++(!verdict.measured ? unknown : verdict.is_reached ? reached : missed);
  }
  std::string text = fmt::format("{} of {} goals reached", reached, result.goals.size());
  if (missed > 0) text += fmt::format(", {} missed", missed);
  if (unknown > 0) text += fmt::format(", {} not measured", unknown);
  return text;
}

std::string how(const BenchResult& result, const char* line_end) {
  return fmt::format(
      "Nanoseconds a state, cosines and sines included: fastest of {0} repetitions in random "
      "order, "
      "{1} states{2}cycled. × MuJoCo, × Simbody: how many times faster than these engines, called "
      "as their users call them",
      result.repetitions, result.states, line_end);
}

}  // namespace

std::string benchText(const BenchResult& result) {
  std::string text;
  for (const auto& table : timeTables(result)) {
    if (text.empty()) text = fmt::format("\n{}.\n", how(result, "\n"));
    text += fmt::format("\n{:<34}", table.scene);
    for (const char* formula : kTimed)
      text += fmt::format(" {:>8} {:>6} {:>6}", std::string(formula) + " [ns]", "xMuJ.", "xSimb.");
    text += "\n";
    for (const auto& row : table.rows) {
      text += fmt::format("{:<34}", row.label);
      for (const TimeCell& cell : row.cells)
        text += fmt::format(" {:>8} {:>6} {:>6}", figure(cell.ns), figure(cell.mujoco),
                            figure(cell.simbody));
      text += "\n";
    }
  }
  for (const auto& table : stepTables(result)) {
    text += fmt::format("\n{:<42}", table.scene + ", whole steps of time");
    for (const char* step : kSteps)
      text +=
          fmt::format(" {:>13} {:>10} {:>7}", std::string(step) + " [ns]", "a second", "x best");
    text += "\n";
    for (const auto& row : table.rows) {
      text += fmt::format("{:<42}", row.label);
      for (const StepCell& cell : row.cells)
        text += fmt::format(" {:>13} {:>10} {:>7}", figure(cell.ns), perSecond(cell.ns),
                            figure(cell.times_best));
      text += "\n";
    }
  }
  const std::vector<OtherNumbers> others = otherNumbers(result);
  if (!others.empty()) text += "\nother numbers\n";
  for (const OtherNumbers& o : others)
    text +=
        fmt::format("{:<64} {}\n", fmt::format("{}, {}: {}", o.subject, o.what, o.label), o.values);
  if (!result.goals.empty())
    text += fmt::format("\n{:<57} {:>26} {:>10} {:>9} {:>20} {:>7}\n", "goal", "wanted", "measured",
                        "x Simbody", "limit", "x limit");
  for (const Goal& goal : result.goals) {
    const GoalVerdict verdict = judge(result, goal);
    text += fmt::format("{} {:<55} {:>26} {:>10} {:>9} {:>20} {:>7}  {}\n", goal.number,
                        goalName(result, goal), wanted(goal), figure(verdict.measured),
                        figure(verdict.times_simbody), limitWords(verdict), timesLimit(verdict),
                        verdictWords(verdict));
  }
  const std::string machine = machineText(result);
  if (!machine.empty()) text += fmt::format("\n{}:\n{}\n", kWhatLimitsAre, machine);
  text += "\n" + goalsSentence(result) + "\n";
  for (const std::string& reason : result.left_out) text += "left out: " + reason + "\n";
  return text;
}

namespace {

void openTable(std::string* page, const char* label, const std::string& caption) {
  *page += fmt::format(
      "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n<table>\n"
      "<caption><span>{}</span></caption>\n",
      label, esc(caption));
}

void putFigure(std::string* page, const BenchFiles& files) {
  if (!files.picture.empty())
    *page += fmt::format(
        "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"Charts of speed\">\n"
        "<img src=\"{}\" width=\"1000\" alt=\"Time of one evaluation of each contender, a panel a "
        "scene and "
        "formula. The numbers are in the table below.\">\n</div>\n",
        files.picture);
  else
    *page += fmt::format("<p class=\"soft\">The plot was left out: {}. Its data are there.</p>\n",
                         esc(files.no_plot_reason));
  *page += fmt::format(
      "<figcaption>Time of one evaluation [s]; further left is better. Data: "
      "<a href=\"{}\">all contenders</a>",
      files.csv);
  if (!files.script.empty())
    *page += fmt::format("; <a href=\"{}\">gnuplot script</a>", files.script);
  *page += ".</figcaption>\n</figure>\n";
}

void putGoals(std::string* page, const BenchResult& result) {
  openTable(
      page, "Table of goals",
      "Goals, and by how much those are missed that are: so much more it takes than granted. " +
          std::string(kWhatLimitsAre) + ".");
  *page +=
      "<thead><tr><th scope=\"col\" class=\"n\">Goal</th><th scope=\"col\">What</th><th "
      "scope=\"col\">Who</th>"
      "<th scope=\"col\" class=\"n\">Wanted</th><th scope=\"col\" class=\"n\">Measured</th>"
      "<th scope=\"col\" class=\"n\">Times Simbody</th><th scope=\"col\" class=\"n\">Limit</th>"
      "<th scope=\"col\" class=\"n\">Times limit</th><th "
      "scope=\"col\">Verdict</th></tr></thead>\n<tbody>\n";
  for (const Goal& goal : result.goals) {
    const GoalVerdict verdict = judge(result, goal);
    const char* css = !verdict.measured ? "none" : verdict.is_reached ? "agree" : "disagree";
    *page += fmt::format(
        "<tr><td class=\"n\">{}</td><th scope=\"row\">{} <span class=\"soft\">of</span> {}</th>"
        "<td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
        "<td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n",
        goal.number, esc(goal.what), esc(goal.subject), esc(result.label(goal.by)),
        esc(wanted(goal)), figure(verdict.measured), figure(verdict.times_simbody),
        limitWords(verdict), timesLimit(verdict), badge(css, verdictWords(verdict)));
  }
  *page += "</tbody>\n</table>\n</div>\n";
  const std::string machine = machineText(result);
  if (!machine.empty())
    *page +=
        fmt::format("<p class=\"soft small\">The machine at its best, {}.</p>\n", esc(machine));
}

void putTimes(std::string* page, const BenchResult& result) {
  for (const auto& table : timeTables(result)) {
    openTable(
        page, "Table of times",
        table.scene + ": nanoseconds a state, and how many times faster than MuJoCo and Simbody.");
    *page += "<thead><tr><th scope=\"col\">Contender</th>";
    for (const char* formula : kTimed)
      *page += fmt::format(
          "<th scope=\"col\" class=\"n\">{} [ns]</th><th scope=\"col\" class=\"n\">× MuJoCo</th>"
          "<th scope=\"col\" class=\"n\">× Simbody</th>",
          formula);
    *page += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
      *page += fmt::format("<tr><th scope=\"row\">{}</th>", esc(row.label));
      for (const TimeCell& cell : row.cells)
        *page +=
            fmt::format("<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>",
                        figure(cell.ns), figure(cell.mujoco), figure(cell.simbody));
      *page += "</tr>\n";
    }
    *page += "</tbody>\n</table>\n</div>\n";
  }
}

void putSteps(std::string* page, const BenchResult& result) {
  for (const auto& table : stepTables(result)) {
    openTable(
        page, "Table of steps",
        table.scene +
            ": whole steps of time, a state, how many a second, and how many times as fast as "
            "the best engine's.");
    *page += "<thead><tr><th scope=\"col\">Contender</th>";
    for (const char* step : kSteps)
      *page += fmt::format(
          "<th scope=\"col\" class=\"n\">{} [ns]</th><th scope=\"col\" class=\"n\">a second</th>"
          "<th scope=\"col\" class=\"n\">× best</th>",
          step);
    *page += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
      *page += fmt::format("<tr><th scope=\"row\">{}</th>", esc(row.label));
      for (const StepCell& cell : row.cells)
        *page +=
            fmt::format("<td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>",
                        figure(cell.ns), perSecond(cell.ns), figure(cell.times_best));
      *page += "</tr>\n";
    }
    *page += "</tbody>\n</table>\n</div>\n";
  }
}

void putOtherNumbers(std::string* page, const BenchResult& result) {
  openTable(page, "Table of other numbers", "What else was measured.");
  *page +=
      "<thead><tr><th scope=\"col\">What</th><th scope=\"col\">Who</th><th "
      "scope=\"col\">Measured</th>"
      "</tr></thead>\n<tbody>\n";
  for (const OtherNumbers& o : otherNumbers(result))
    *page += fmt::format(
        "<tr><th scope=\"row\">{} <span class=\"soft\">of</span> "
        "{}</th><td>{}</td><td>{}</td></tr>\n",
        esc(o.what), esc(o.subject), esc(o.label), esc(o.values));
  *page += "</tbody>\n</table>\n</div>\n";
}

}  // namespace

std::string benchSection(const BenchResult& result, const BenchFiles& files) {
  const Environment& where = result.environment;
  std::string page = fmt::format(
      "<section aria-labelledby=\"speed\">\n<h2 id=\"speed\">Speed</h2>\n<p>{}.</p>\n"
      "<p>Measured by <code>dynwitness bench</code> on {}, {}. Nothing of the verdict above "
      "depends on it. {}.</p>\n"
      "<figure class=\"charts\">\n",
      esc(goalsSentence(result)), esc(where.cpu), esc(where.date), esc(how(result, " ")));
  putFigure(&page, files);
  putGoals(&page, result);
  putTimes(&page, result);
  putSteps(&page, result);
  putOtherNumbers(&page, result);
  if (!result.left_out.empty()) {
    page += "<p class=\"soft\">Left out:</p>\n<ul class=\"reasons\">\n";
    for (const std::string& reason : result.left_out) page += "<li>" + esc(reason) + "</li>\n";
    page += "</ul>\n";
  }
  std::string libraries;
  for (const Environment::Library& library : where.libraries)
    libraries +=
        fmt::format("{}{} {}", libraries.empty() ? "" : ", ", library.name, library.version);
  return page + fmt::format(
                    "<p class=\"soft small\">dynwitness {}{}; {} processors, load {:.1f} before; "
                    "{} {}; {}</p>\n"
                    "</section>\n",
                    esc(where.version), where.commit.empty() ? "" : ", commit " + esc(where.commit),
                    result.processors, result.load, esc(where.compiler), esc(where.flags),
                    esc(libraries));
}

}  // namespace dynwitness::crosscheck
