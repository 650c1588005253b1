// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/chart_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "crosscheck/chart/timed_apart.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {

std::string chartCsv(const std::vector<Chart>& charts) {
  std::string quantities, left_out, own_calls, rows;
  for (const Chart& chart : charts) {
    quantities += (quantities.empty() ? "" : ", ") + chart.quantity;
    for (const std::string& words : chart.own_calls)
      own_calls += fmt::format("# {} by {}\n", chart.quantity, oneLine(words));
    for (const std::string& method : chart.left_out)
      left_out += fmt::format("# left out of {}: {}\n", chart.quantity, oneLine(method));
    for (const ChartPoint& p : chart.points)
      rows += fmt::format("{},{},{},{:.3e},{:.3e},{:.1f},{:.1f},{:.1f}\n", chart.quantity, p.method,
                          name(p.scalar), p.error_worst, p.error_median, p.time_min_ns,
                          p.time_median_ns, p.time_high_ns);
  }
  std::string about;
  if (!charts.empty())
    about = fmt::format(
        "# scene: {}\n# quantity: {}\n# states: {}, seed {}\n"
        "# error: largest |entry - truth| / largest |truth| of a state; the truth is certified by "
        "ball arithmetic to 2^-{}\n"
        "# time: CPU time of one evaluation, from joint positions as numbers: cosines, sines and "
        "position kinematics included; fastest, median and 90 % of {} batches, up to {} times\n"
        "# lanes: all states of a batch in one call, its time divided by their number\n"
        "# engines: timed by their own calls; \"by its witness\": with our copies and conversions\n"
        "# machine: {}\n",
        oneLine(charts.front().scene), quantities, charts.front().states, charts.front().seed,
        kChartTruthBits, kChartBatches, kChartRounds, oneLine(charts.front().machine));
  return about + own_calls + left_out +
         "quantity,method,scalar,error_worst,error_median,time_min_ns,time_median_ns,"
         "time_high_ns\n" +
         rows;
}

namespace {

/// Colour and marker of a method, the same in every chart: a line type of style.gp.
int lineTypeOfMethod(const std::string& method) {
  static const std::map<std::string, int> known = {{MethodName::kNewtonEuler, 1},
                                                   {MethodName::kClosedForm, 2},
                                                   {MethodName::kProgram, 3},
                                                   {MethodName::kCompositeBody, 4},
                                                   {MethodName::kCompositeBodySolved, 4},
                                                   {MethodName::kArticulatedBody, 5},
                                                   {MethodName::kKernel, 6},
                                                   {kFastMethod, 7},
                                                   {kLanesMethod, 8}};
  const auto found = known.find(method);
  const std::string engine = method.substr(0, method.find(kByItsWitness));
  return found != known.end() ? found->second : lineTypeOfEngine(engine).value_or(16);
}

/// What is seen of the points: decades of error and of time [s]; an exact answer, which has no
/// place on a log axis, is drawn at the left border.
struct Range {
  double left = 0, right = -400, bottom = 400, top = -400;

  Range(const std::vector<ChartPoint>& points, bool only_double) {
    for (const ChartPoint& p : points) {
      if (only_double && p.scalar != Scalar::kDouble) continue;
      for (const double error : {p.error_worst, p.error_median}) {
        if (!(error > 0) || !std::isfinite(error)) continue;
        left = std::min(left, std::floor(std::log10(error)));
        right = std::max(right, std::ceil(std::log10(error)));
      }
      bottom = std::min(bottom, std::log10(1e-9 * p.time_min_ns));
      top = std::max(top, std::log10(1e-9 * p.time_high_ns));
    }
    if (right < left) left = -17, right = -15;  // all exact
    left -= only_double ? 1 : 3;
    right += only_double ? 0 : 3;
    bottom -= 0.3;
    top += 0.3;
  }
};

std::string panel(const Chart& chart, const std::string& csv, bool only_double) {
  const Range range(chart.points, only_double);
  std::vector<std::string> methods;
  for (const ChartPoint& p : chart.points)
    if ((!only_double || p.scalar == Scalar::kDouble) &&
        std::find(methods.begin(), methods.end(), p.method) == methods.end())
      methods.push_back(p.method);
  const double decades = range.right - range.left;
  std::string text = fmt::format(
      "set xrange [1e{0:.0f}:1e{1:.0f}]\nset xtics 1e{0:.0f},1e{2:.0f}\n"
      "set yrange [{3:.3g}:{4:.3g}]\nborder = 1e{0:.0f}\nplot ",
      range.left, range.right, std::max(1.0, std::ceil(decades / 6)), std::pow(10, range.bottom),
      std::pow(10, range.top));
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const std::string chosen = fmt::format("strcol(2) eq {}{}", gnuplotString(methods[i]),
                                           only_double ? " && strcol(3) eq 'double'" : "");
    const auto settings =
        std::count_if(chart.points.begin(), chart.points.end(),
                      [&](const ChartPoint& p) { return p.method == methods[i]; });
    text += i == 0 ? "" : ", \\\n     ";
    // of the CSV: 2 method, 3 scalar, 4 worst and 5 median error, 6 to 8 time fastest to 90 %
    if (!only_double && settings > 1) {
      text += fmt::format(
          "'{}' using ({} ? seen($4) : NaN):(1e-9 * $7) with lines linetype {} dashtype 1 "
          "linewidth 1 notitle, \\\n     ",
          csv, chosen, lineTypeOfMethod(methods[i]));
      // names stand where no other method can be: those lie above double, in double
      const std::pair<const char*, const char*> places[] = {
          {"among(strcol(3)) && $4 > border", "right offset -2.4,0"},
          {"strcol(3) eq 'float' && !($4 > border)", "left offset 0.9,-0.6"},
          {"!(among(strcol(3)) && $4 > border) && !(strcol(3) eq 'float' && !($4 > border))",
           "left offset 0.7,0.6"}};
      for (const auto& [rows, place] : places)
        text += fmt::format(
            "'{}' using ({} && {} ? seen($4) : NaN):(1e-9 * $7):3 with labels {} font ',11' "
            "textcolor rgb soft notitle, \\\n     ",
            csv, chosen, rows, place);
    }
    text += fmt::format(
        "'{}' using ({} ? seen($4) : NaN):(1e-9 * $7):(seen($5)):(seen($4)):(1e-9 * $6):(1e-9 * "
        "$8) with xyerrorbars linetype {} dashtype 1 linewidth 1.5 {}",
        csv, chosen, lineTypeOfMethod(methods[i]),
        only_double ? "title " + gnuplotString(methods[i]) : std::string("notitle"));
  }
  return text + "\n";
}

}  // namespace

std::string chartScript(const Chart& chart, const std::string& name, const std::string& style) {
  const std::string title = chart.title.empty() ? chart.scene : chart.title;
  const std::string csv = name + ".csv";
  const std::string task = chart.quantity == crosscheck::name(Quantity::kM) ? "mass matrix"
                           : chart.quantity == crosscheck::name(Quantity::kTau)
                               ? "inverse dynamics"
                               : "forward dynamics";
  std::string text = fmt::format(
      "# Speed against accuracy of {0} of {1}. Draw again with:  gnuplot {2}.gp\n"
      "load '{3}'\n"
      "eval canvas(1000, 480, 13)\n"
      "set output picture_file('{2}')\n"
      "set multiplot\n"
      "set label 1 {4} at screen 0.5, screen 0.96 center textcolor rgb ink font ',15'\n"
      "set label 2 {5} at screen 0.5, screen 0.025 center textcolor rgb soft font ',11'\n"
      "set label 3 'sines and position kinematics are in each time; engines by their own calls, but for "
      "those by their witness, whose conversions are in it' at screen 0.5, screen 0.92 center "
      "textcolor rgb soft font ',11'\n"
      "set tmargin at screen 0.825\nset bmargin at screen 0.28\n"
      "set logscale xy\nset format x '1e%T'\nset format y '%.0s %cs'\nset micro\nunset mxtics\n"
      "seen(error) = error > border ? error : border\n"
      "among(scalar) = scalar eq 'double' || scalar eq 'long double'\n"
      "set bars 0.6\n"
      "set xlabel 'worst relative error  [1]'\n",
      chart.quantity, oneLine(chart.scene), name, style,
      gnuplotString(fmt::format("{}, {}: lower left is better", title, task)),
      gnuplotString(
          fmt::format("worst of {} states against the certified truth, bars to the median (exact: "
                      "left border); median time, bars from the fastest to 90 %; {}",
                      chart.states, chart.machine)));
  text +=
      "set lmargin at screen 0.085\nset rmargin at screen 0.5\n"
      "set title 'The sweep in five arithmetics' textcolor rgb soft\n"
      "set ylabel 'time of one evaluation'\nunset key\n" +
      panel(chart, csv, false);
  const auto named = std::count_if(chart.points.begin(), chart.points.end(),
                                   [](const ChartPoint& p) { return p.scalar == Scalar::kDouble; });
  text +=
      "unset label\nunset ylabel\n"
      "set lmargin at screen 0.575\nset rmargin at screen 0.97\n"
      "set title 'In double' textcolor rgb soft\n" +
      // gnuplot leaves out what does not fit: four columns do
      fmt::format(
          "set key at screen 0.5, screen 0.105 center center vertical Left reverse "
          "maxrows {}\n",
          (named + 3) / 4) +
      panel(chart, csv, true);
  return text + "unset multiplot\nunset output\n";
}

}  // namespace dynwitness::crosscheck
