// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/report/bench.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double kNanoseconds = 1e9;  // in a second

/// Scenes that were timed, in the order in which they were measured.
std::vector<std::string> timedScenes(const BenchResult& result) {
  std::vector<std::string> scenes;
  for (const Measurement& m : result.measured)
    if (m.isTime() && std::find(scenes.begin(), scenes.end(), m.subject) == scenes.end())
      scenes.push_back(m.subject);
  return scenes;
}

/// The time that a goal grants [ns].
std::optional<double> granted(const BenchResult& result, const Measurement& m) {
  const auto mujoco = result.value(m.what, m.subject, kRawMujoco, "ns");
  for (const Goal& goal : result.goals)
    if (mujoco && goal.unit == kTimesMujoco && goal.what == m.what && goal.subject == m.subject &&
        goal.by == m.by)
      return *mujoco / goal.wanted;
  return std::nullopt;
}

/// Who is timed, from top to bottom.
std::vector<Contender> timedContenders(const BenchResult& result) {
  std::vector<Contender> all;
  for (const Contender& c : result.contenders)
    if (std::any_of(result.measured.begin(), result.measured.end(),
                    [&](const Measurement& m) { return m.isTime() && m.by == c.name; }))
      all.push_back(c);
  return all;
}

/// Colour and marker: an engine's as in the other charts; ours by what it is, whoever compiled it.
int lineTypeOfContender(const std::string& contender) {
  const auto starts = [&](const char* word) { return contender.rfind(word, 0) == 0; };
  if (const auto engine = lineTypeOfEngine(contender.substr(0, contender.rfind("_raw"))))
    return *engine;
  if (starts("recursive")) return 5;
  if (starts("fast")) return 1;
  if (starts("kernel_lanes")) return 3;
  if (starts("kernel_all")) return 4;
  if (starts("kernel")) return 2;
  return 16;
}

const char* words(const std::string& formula) {
  return formula == "ID" ? "inverse dynamics" : formula == "M" ? "mass matrix" : "forward dynamics";
}

}  // namespace

std::string benchCsv(const BenchResult& result) {
  std::string text = fmt::format(
      "# time of one evaluation, cosines and sines included; {} seeded states cycled (seed {}), "
      "fastest of {}\n"
      "# goal_ns: what the goal grants, as a share of MuJoCo's time\n# machine: {}\n",
      result.states, result.seed, result.repetitions, oneLine(result.environment.cpu));
  for (const Contender& c : result.contenders)
    text += fmt::format("# {}: {}\n", oneLine(c.name), oneLine(c.label));
  text += "scene,formula,contender,time_ns,times_mujoco,times_simbody,goal_ns\n";
  const auto number = [](const std::optional<double>& x) {
    return x ? fmt::format("{:.4g}", *x) : std::string();
  };
  for (const Measurement& m : result.measured) {
    if (!m.isTime()) continue;
    text += fmt::format("{},{},{},{:.5g},{},{},{}\n", oneLine(m.subject), m.what, oneLine(m.by),
                        m.value, number(result.timesFaster(kRawMujoco, m.what, m.subject, m.by)),
                        number(result.timesFaster(kRawSimbody, m.what, m.subject, m.by)),
                        number(granted(result, m)));
  }
  return text;
}

std::string benchScript(const BenchResult& result, const std::string& style) {
  const std::vector<std::string> scenes = timedScenes(result);
  const std::vector<Contender> contenders = timedContenders(result);
  if (scenes.empty() || contenders.empty()) return {};
  const double lines = static_cast<double>(contenders.size());
  // in pixels: a head, for each scene a title, its lines and an axis, and a foot
  const double head = 46, line = 20, around = 104, foot = 24;
  const double panel = line * lines,
               height = head + foot + (panel + around) * static_cast<double>(scenes.size());
  std::string text = fmt::format(
      "# Speed of our sweeps and kernels beside the engines. Draw again with:  gnuplot bench.gp\n"
      "load '{}'\n"
      "eval canvas(1000, {:.0f}, 13)\n"
      "set output picture_file('bench')\nset multiplot\n"
      "set label 1 'Time of one evaluation: further left is better' at screen 0.5, screen {:.4f} "
      "center "
      "textcolor rgb ink font ',15'\n"
      "set label 2 {} at screen 0.5, screen {:.4f} center textcolor rgb soft font ',11'\n"
      "set logscale x\nset format x '%.0s %cs'\nset xlabel 'time a state'\nset yrange "
      "[{}:0.3]\nunset key\n",
      style, height, 1 - 20 / height,
      gnuplotString(
          fmt::format("numbers: how many times faster than MuJoCo; bars: what the goals grant; {}",
                      oneLine(result.environment.cpu))),
      10 / height, lines + 0.7);
  std::string names;
  for (std::size_t i = 0; i < contenders.size(); ++i)
    names += fmt::format("{}{} {}", i == 0 ? "" : ", ", gnuplotString(contenders[i].label), i + 1);
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const Measurement& m : result.measured) {
      if (!m.isTime() || m.subject != scenes[s]) continue;
      least = std::min({least, m.value, granted(result, m).value_or(m.value)});
      most = std::max(most, m.value);
    }
    const double top = 1 - (head + 34 + (panel + around) * static_cast<double>(s)) / height;
    text += fmt::format(
        "set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\nset xrange [{:.3g}:{:.3g}]\n",
        top, top - panel / height, least / 2 / kNanoseconds, most * 8 / kNanoseconds);
    int column = 0;
    for (const char* formula : kTimed) {
      const auto measured = [&](const Contender& c) {
        return result.value(formula, scenes[s], c.name, "ns").has_value();
      };
      const double left = 0.235 + 0.255 * column;
      if (!std::any_of(contenders.begin(), contenders.end(), measured)) continue;
      ++column;
      text += fmt::format(
          "set lmargin at screen {:.3f}\nset rmargin at screen {:.3f}\n"
          "set title {} textcolor rgb soft\n"
          "set ytics ({})\nset format y '{}'\nplot ",
          left, left + 0.235, gnuplotString(fmt::format("{}, {}", scenes[s], words(formula))),
          column == 1 ? names : [&] {
            std::string ticks;
            for (std::size_t i = 0; i < contenders.size(); ++i)
              ticks += fmt::format("{}'' {}", i == 0 ? "" : ", ", i + 1);
            return ticks;
          }(), "%s");
      bool first = true;
      for (std::size_t i = 0; i < contenders.size(); ++i) {
        if (!measured(contenders[i])) continue;
        const std::string chosen =
            fmt::format("strcol(1) eq {} && strcol(2) eq '{}' && strcol(3) eq {}",
                        gnuplotString(scenes[s]), formula, gnuplotString(contenders[i].name));
        // of the CSV: 4 time, 5 times MuJoCo, 7 what the goal grants [ns]
        text += fmt::format(
            "{0}'bench.csv' using ({1} && strlen(strcol(7)) ? $7 / {2:g} : NaN):({3} - "
            "0.38):(0):(0.76) with vectors nohead linetype 20 dashtype 1 linewidth 2 notitle, \\\n"
            "     "
            "'bench.csv' using ({1} ? $4 / {2:g} : NaN):({3}) with points linetype {4} notitle, "
            "\\\n     'bench.csv' using ({1} && strlen(strcol(5)) ? {5:g} : NaN):({3}):(sprintf($5 "
            "< 1 ? '%.2g' : $5 < 10 ? '%.1f' : '%.0f', $5)) with labels right font ',11' textcolor "
            "rgb ink notitle",
            first ? "" : ", \\\n     ", chosen, kNanoseconds, i + 1,
            lineTypeOfContender(contenders[i].name), most * 7 / kNanoseconds);
        first = false;
      }
      text += "\nunset label\n";
    }
  }
  return text + "unset multiplot\nunset output\n";
}

}  // namespace dynwitness::crosscheck
