// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/motions_picture.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/report/work_drawing.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

namespace {

/// How far the positions of two states are apart [rad, m, 1].
double apart(const scene::Mechanism& mechanism, const Simulation::Point& a,
             const Simulation::Point& b) {
  std::vector<double> of_a = a.q, of_b = b.q;
  of_a.push_back(0), of_b.push_back(0);  // as placed() has it, without rates
  const std::vector<long double> there = placed(mechanism, of_b),
                                 here = placed(mechanism, of_a, there);
  return static_cast<double>(largestGap(there, here, there.size()));
}

}  // namespace

std::string motionsCsv(const scene::Scene& scene, const FormulationComparison& comparison) {
  std::string csv = "method,time_s,energy_error_J,q_apart\n";
  const std::vector<Simulation::Point>& right = comparison.reference_run.points;
  for (const FormulationRun& run : comparison.runs)
    for (std::size_t k = 0; k < std::min(right.size(), run.result.points.size()); ++k) {
      const Simulation::Point& point = run.result.points[k];
      csv += fmt::format("{},{:.17g},{:.3g},{:.3g}\n", run.method, point.time, point.energy_error,
                         apart(scene.mechanism, point, right[k]));
    }
  return csv;
}

namespace {

std::string scriptOf(const scene::Scene& scene, const FormulationComparison& comparison) {
  const auto panel = [&](int column) {
    std::string plots;
    for (const FormulationRun& run : comparison.runs) {
      if (!run.failure.empty()) continue;
      plots += fmt::format(
          "{}'methods.csv' using (strcol(1) eq {} && ${} > 0 ? $2 : NaN):{} with linespoints {} "
          "pointinterval {} title {}",
          plots.empty() ? "" : ", \\\n     ", gnuplotString(run.method), column, column,
          lookOfMethod(run.method),
          std::max<std::size_t>(1, run.result.points.size() / 12),  // marks, not a band of them
          gnuplotString(run.method));
    }
    return plots;
  };
  return fmt::format(
      "load 'style.gp'\n"
      "eval canvas(1000, 720, 13)\n"
      "set output picture_file('methods')\nset multiplot\n"
      "set label 1 {} at screen 0.5, screen 0.965 center textcolor rgb ink font ',15'\n"
      "set lmargin at screen 0.1\nset rmargin at screen 0.74\n"
      "set logscale y\nset format y '1e%T'\nunset mytics\nset xrange [0:{}]\n"
      "set key at screen 0.75, graph 1 left top Left reverse samplen 2\n"
      "set tmargin at screen 0.93\nset bmargin at screen 0.54\nset format x ''\n"
      "set ylabel '|E − E₀ − work|  [J]'\nplot {}\nunset label 1\n"
      "set tmargin at screen 0.5\nset bmargin at screen 0.1\nset format x '%g'\n"
      "set xlabel 'time  [s]'\nset ylabel '|q − q of the reference|  [rad, m]'\nunset key\n"
      "plot {}\nunset multiplot\nunset output\n",
      gnuplotString((scene.title.empty() ? scene.name : scene.title) + ": lower is better"),
      comparison.reference.duration, panel(3), panel(4));
}

}  // namespace

void drawMotions(const scene::Scene& scene, const FormulationComparison& comparison,
                 const std::filesystem::path& file, const PictureLook& look) {
  const auto hasRun = [](const FormulationRun& run) { return run.failure.empty(); };
  if (std::none_of(comparison.runs.begin(), comparison.runs.end(), hasRun))
    throw std::runtime_error("no method came to an end: nothing to draw");
  const UnfinishedFolder work(file.string() + ".work");  // vanishes again
  work.write("style.gp", kStyleGnuplot);
  work.write("methods.csv", motionsCsv(scene, comparison));
  work.write("methods.gp", scriptOf(scene, comparison));
  drawTo(file, work.path(), "methods", look);
}

}  // namespace dynwitness::cli
