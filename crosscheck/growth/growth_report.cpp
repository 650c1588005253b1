// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/growth/growth.hpp"
#include "crosscheck/growth/ours.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/environment.hpp"

namespace dynwitness::crosscheck {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kIdColumn = 4, kFdColumn = 5, kBytesColumn = 8, kErrorColumn = 10;

std::vector<std::string> familiesOf(const std::vector<GrowthPoint>& points) {
  std::vector<std::string> families;
  for (const GrowthPoint& p : points)
    if (std::find(families.begin(), families.end(), p.family) == families.end())
      families.push_back(p.family);
  return families;
}

/// "reached" or by how much not.
std::string verdict(const GrowthGoal& goal) {
  if (!goal.isMeasured()) return "not measured";
  if (goal.isReached()) return "reached";
  if (goal.is_least) return fmt::format("MISSED by {:.2g}", goal.limit - goal.measured);
  return fmt::format("MISSED by {:.0f} %", 100 * (goal.measured / goal.limit - 1));
}

std::string goalsText(const std::vector<GrowthPoint>& points, double cache) {
  std::string text = fmt::format("#\n# {:<6} {:<42} {:>12} {:>14}  {:<12} {:>8}\n", "family",
                                 "goal", "limit", "measured", "", "links");
  for (const GrowthGoal& goal : growthGoals(points, cache)) {
    const std::string at = goal.isMeasured() ? std::to_string(goal.links) : "-";
    const std::string measured = goal.isMeasured() ? fmt::format("{:.4g}", goal.measured) : "-";
    text += fmt::format("# {:<6} {:<42} {:>3}{:>9.4g} {:>14}  {:<12} {:>8}  {}\n", goal.family,
                        goal.goal, goal.is_least ? ">=" : "<=", goal.limit, measured, goal.unit, at,
                        verdict(goal));
  }
  return text +
         fmt::format(
             "# times: against {0} links; the model against its fastest from {0} to {1} links\n",
             kGrowthFrom, kGrowthBuildTo);
}

}  // namespace

std::string growthCsv(const std::vector<GrowthPoint>& points, const GrowthOptions& options,
                      double cache) {
  std::string failures, fits, rows;
  const auto number = [](double x, const char* format) {
    return std::isnan(x) ? std::string() : fmt::format(fmt::runtime(format), x);
  };
  for (const std::string& family : familiesOf(points))
    if (const int fit = linksInCache(points, family, cache))
      fits += fmt::format("{}{} links of a {}", fits.empty() ? "" : ", ", fit, family);
  for (const GrowthPoint& p : points) {
    if (!p.failure.empty())
      failures += fmt::format("# {} at {}_{}: {}\n", p.method, p.family, p.links, p.failure);
    rows += fmt::format(
        "{},{},{},{},{},{},{},{},{},{}\n", p.family, p.links, p.method, number(p.id_ns, "{:.1f}"),
        number(p.fd_ns, "{:.1f}"), number(p.scene_ns, "{:.0f}"), number(p.build_ns, "{:.0f}"),
        number(p.bytes, "{:.0f}"), number(p.peak_bytes, "{:.0f}"), number(p.fd_error, "{:.2e}"));
  }
  return fmt::format(
             "# chains and binary trees of equal links, state 0 of seed {}; M is formed by none "
             "of ours\n"
             "# id, fd: CPU time of one call, cosines and sines included, fastest; engines "
             "through their "
             "witness\n"
             "# scene, build: CPU time to make the scene, and from it what is asked\n"
             "# bytes: kept on the heap after building and asking, without the scene and the "
             "caller's five "
             "numbers a link\n"
             "# peak: scene, building and asking, the whole process, from {} links on\n"
             "# fd_error: largest |qdd - truth| / largest |truth|, an upper bound certified by "
             "ball "
             "arithmetic, up to {} links\n"
             "# last-level cache: {}\n# machine: {}\n",
             options.seed, kGrowthPeakFrom, options.most_links_with_truth,
             cache > 0 ? fmt::format("{:.0f} MB, room for {}", cache / (1 << 20), fits)
                       : "not known",
             oneLine(cpuModel())) +
         failures +
         "family,links,method,id_ns_per_link,fd_ns_per_link,scene_ns_per_link,build_ns_per_link,"
         "bytes_per_link,peak_bytes_per_link,fd_error\n" +
         rows + goalsText(points, cache);
}

std::string growthJson(const std::vector<GrowthPoint>& points, const GrowthOptions& options,
                       double cache, const std::string& version) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  Json rows = Json::array(), goals = Json::array(), fits = Json::object();
  for (const GrowthPoint& p : points)
    rows.push_back({{"family", p.family},
                    {"links", p.links},
                    {"method", p.method},
                    {"id_ns_per_link", number(p.id_ns)},
                    {"fd_ns_per_link", number(p.fd_ns)},
                    {"scene_ns_per_link", number(p.scene_ns)},
                    {"build_ns_per_link", number(p.build_ns)},
                    {"bytes_per_link", number(p.bytes)},
                    {"peak_bytes_per_link", number(p.peak_bytes)},
                    {"fd_error", number(p.fd_error)},
                    {"failure", p.failure.empty() ? Json(nullptr) : Json(p.failure)}});
  for (const GrowthGoal& goal : growthGoals(points, cache))
    goals.push_back({{"goal", goal.goal},
                     {"family", goal.family},
                     {"unit", goal.unit},
                     {"limit", goal.limit},
                     {"is_least", goal.is_least},
                     {"measured", number(goal.measured)},
                     {"links", goal.isMeasured() ? Json(goal.links) : Json(nullptr)},
                     {"is_time", goal.is_time},
                     {"verdict", !goal.isMeasured() ? "not measured"
                                 : goal.isReached() ? "reached"
                                                    : "missed"}});
  for (const std::string& family : familiesOf(points)) {
    const int fit = linksInCache(points, family, cache);
    fits[family] = fit > 0 ? Json(fit) : Json(nullptr);
  }
  const Json all = {
      {"dynwitness", version},  {"machine", oneLine(cpuModel())},
      {"seed", options.seed},   {"cache_bytes", cache > 0 ? Json(cache) : Json(nullptr)},
      {"links_in_cache", fits}, {"points", rows},
      {"goals", goals}};
  return all.dump(2) + "\n";
}

std::string growthScript(const std::vector<GrowthPoint>& points, const std::string& family,
                         double cache, const std::string& style) {
  const auto lineType = [](const std::string& method) {
    return method == kFastMethod       ? 1
           : method == kTextbookMethod ? 5
                                       : lineTypeOfEngine(method).value_or(16);
  };
  std::vector<std::string> methods;
  int most = 1;
  for (const GrowthPoint& p : points) {
    if (p.family != family) continue;
    most = std::max(most, p.links);
    if (std::find(methods.begin(), methods.end(), p.method) == methods.end())
      methods.push_back(p.method);
  }
  const auto plot = [&](int column, bool is_time, bool with_titles) {
    std::string text = "plot ";
    for (std::size_t i = 0; i < methods.size(); ++i) {
      text += fmt::format(
          "{}'growth.csv' using (strcol(1) eq '{}' && strcol(3) eq {} && strlen(strcol({})) ? $2 "
          ": NaN):{} "
          "with linespoints linetype {} {}",
          i == 0 ? "" : ", \\\n     ", family, gnuplotString(methods[i]), column,
          is_time ? fmt::format("(1e-9 * ${})", column) : std::to_string(column),
          lineType(methods[i]),
          with_titles ? "title " + gnuplotString(methods[i]) : std::string("notitle"));
    }
    return text + "\n";
  };
  std::string ticks, largest = std::to_string(most);
  constexpr const char* kPowers[] = {"1", "10", "100", "1000", "10⁴", "10⁵", "10⁶"};
  double power = 1;
  for (const char* label : kPowers) {
    ticks += fmt::format("{}'{}' {:.0f}", ticks.empty() ? "" : ", ", label, power);
    if (most == power) largest = label;
    power *= 10;
  }
  const int fit = linksInCache(points, family, cache);
  const std::string edge =
      fit > 0 && fit < most
          ? fmt::format(
                "set arrow 1 from {0}, graph 0 to {0}, graph 1 nohead linetype 20\n"
                "set label 2 '{1:.0f} MB of cache end here' at {0}, graph 0.95 right offset -0.5,0 "
                "textcolor rgb soft font ',11'\n",
                fit, cache / (1 << 20))
          : std::string();
  const auto panel = [&](int row, int column, const char* title, const char* format) {
    return fmt::format(
        "set tmargin at screen {}\nset bmargin at screen {}\nset lmargin at screen {}\n"
        "set rmargin at screen {}\n"
        "set title '{}' textcolor rgb soft\nset format y '{}'\nset xlabel '{}'\n",
        row == 0 ? 0.9 : 0.49, row == 0 ? 0.59 : 0.18, column == 0 ? 0.085 : 0.58,
        column == 0 ? 0.475 : 0.97, title, format, row == 0 ? "" : "links");
  };
  return fmt::format(
             "# Growth of inverse and forward dynamics. Draw again with:  gnuplot {0}.gp\n"
             "load '{1}'\n"
             "eval canvas(1000, 760, 13)\n"
             "set output picture_file('{0}')\nset multiplot\n"
             "set label 1 '{2} of 1 to {6} links: lower is better' at screen 0.5, screen 0.97 "
             "center "
             "textcolor rgb ink font ',15'\n"
             "set logscale xy\nset xrange [1:{3}]\nset xtics ({4})\nset micro\n"
             "set datafile missing NaN\n"
             "set key at screen 0.5, screen 0.06 center center vertical Left reverse maxrows {5}\n",
             family, style, family == "tree" ? "Binary trees" : "Chains", most, ticks,
             (methods.size() + 3) / 4, largest) +
         panel(0, 0, "Inverse dynamics: CPU time a link [s]", "%.0s %cs") + edge +
         plot(kIdColumn, true, true) + "unset label 1\nunset key\n" +
         panel(0, 1, "Forward dynamics: CPU time a link [s]", "%.0s %cs") +
         plot(kFdColumn, true, false) + "unset arrow 1\nunset label 2\n" +
         panel(1, 0, "Memory kept a link [bytes]", "%.0s %cB") + plot(kBytesColumn, false, false) +
         panel(1, 1, "Forward dynamics: largest |qdd - truth| / largest |truth|", "1e%T") +
         plot(kErrorColumn, false, false) + "unset multiplot\nunset output\n";
}

}  // namespace dynwitness::crosscheck
