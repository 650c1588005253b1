// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/work_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/text.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr const char* kReached = "reached";

/// Colour and dashes of a family, mark of a method: line type and point type of style.gp, the same
/// in every chart.
struct Look {
  int line, point;
};
Look lookOf(const std::string& method) {
  static const std::map<std::string, Look> looks = {
      {"euler", {2, 5}},
      {"semi_implicit_euler", {2, 4}},
      {"implicit_euler", {2, 12}},
      {"modified_midpoint", {1, 9}},
      {"runge_kutta4", {1, 7}},
      {"runge_kutta_dopri5", {1, 5}},
      {"runge_kutta_fehlberg78", {1, 13}},
      {"bulirsch_stoer8", {6, 6}},
      {"adams_bashforth_moulton4", {6, 8}},
      {"lie_runge_kutta4", {6, 14}},
      {"stormer_verlet", {3, 9}},
      {"implicit_midpoint", {3, 7}},
      {"gauss_4", {3, 5}},
      {"gauss_6", {3, 13}},
      {"rosenbrock4", {5, 4}},
      {"radau_iia_3", {4, 8}},
      {"radau_iia_5", {4, 12}},
      // of closed mechanisms
      {"semi_implicit_euler projection", {2, 4}},
      {"runge_kutta4 index1", {1, 9}},
      {"runge_kutta4 baumgarte", {1, 6}},
      {"runge_kutta4 projection", {1, 7}},
      {"runge_kutta_dopri5 projection", {1, 5}},
      {"runge_kutta_fehlberg78 projection", {1, 13}},
      {"bulirsch_stoer8 projection", {6, 6}},
      {"gauss_6 projection", {3, 13}},
      {"implicit_euler index2", {2, 12}},
      {"radau_iia_3 index2", {5, 8}},
      {"radau_iia_5 projection", {4, 12}},
      {"radau_iia_5 index2", {4, 14}},
      {"radau_iia_5 index3", {4, 9}},
      {"radau_iia_5 ggl", {4, 5}},
  };
  const auto found = looks.find(method);
  return found == looks.end() ? Look{16, 3} : found->second;
}

std::string orderText(double order) {
  return order > 0 ? fmt::format("{:.2f}", order) : "no range";
}

/// Decades of what is drawn.
struct Range {
  double low = 400, high = -400;
  void take(double value) {
    if (!(value > 0) || !std::isfinite(value)) return;
    low = std::min(low, std::log10(value));
    high = std::max(high, std::log10(value));
  }
};

std::string panel(const WorkPrecision& work, const std::string& csv, int error_column,
                  int cost_column, bool with_key) {
  std::string text = "plot ";
  for (const WorkLine& line : work.lines) {
    if (line.points.empty()) continue;
    const Look look = lookOf(line.method);
    const std::string mine = fmt::format("strcol(1) eq {}", gnuplotString(line.method));
    text += text == "plot " ? "" : ", \\\n     ";
    text += fmt::format(
        "'{}' using ({} && strcol(9) eq '{}' ? seen(${}) : NaN):{} with linespoints linetype {} "
        "pointtype {} {}",
        csv, mine, kReached, error_column, cost_column, look.line, look.point,
        with_key ? "title " + gnuplotString(fmt::format("{}: {} ({})", line.method,
                                                        orderText(line.observed_order), line.order))
                 : std::string("notitle"));
    const bool fails = std::any_of(line.points.begin(), line.points.end(),
                                   [](const WorkPoint& p) { return !p.failure.empty(); });
    if (fails)
      text += fmt::format(
          ", \\\n     '{0}' using ({1} && strcol(9) ne '{2}' ? failed : NaN):{3} with points linetype "
          "{4} pointtype {5} notitle, \\\n     '{0}' using ({1} && strcol(9) ne '{2}' ? failed : "
          "NaN):{3} with points linetype {4} pointtype 2 pointsize 1.4 notitle",
          csv, mine, kReached, cost_column, look.line, look.point);
  }
  return text + "\n";
}

}  // namespace

std::string lookOfMethod(const std::string& method) {
  const Look look = lookOf(method);
  return fmt::format("linetype {} pointtype {}", look.line, look.point);
}

std::string referenceText(const ReferenceMotion& reference) {
  std::string text = fmt::format("{} agree to {} places", reference.by, reference.digits());
  if (reference.elliptic_error)
    text += fmt::format(", the elliptic functions are {:.1g} away", *reference.elliptic_error);
  if (!reference.published.empty()) text += "; " + reference.published;
  return text;
}

std::string workCsv(const WorkPrecision& work) {
  std::string csv = fmt::format(
      "# scene: {}\n# duration: {} s\n# reference: {}\n"
      "# error: largest |q - reference|, |qd - reference| at the end [rad, m, rad/s, m/s]\n"
      "# energy_error: largest |E - E0| after a step / {:.6g} J, the largest kinetic energy\n"
      "# observed_order: between the two finest steps above rounding; 0: none\n"
      "# cpu_s: fastest of some runs; machine: {}\n",
      oneLine(work.scene), work.duration, referenceText(work.reference),
      work.reference.most_kinetic, oneLine(work.machine));
  for (const WorkLine& line : work.lines)
    if (!line.left_out.empty())
      csv += fmt::format("# left out: {}: {}\n", line.method, oneLine(line.left_out));
  for (const WorkLine& line : work.lines)
    if (!line.no_order.empty())
      csv += fmt::format("# no order: {}: {}\n", line.method, oneLine(line.no_order));
  csv += "method,order,observed_order,step_s,rhs_calls,cpu_s,error,energy_error,end\n";
  for (const WorkLine& line : work.lines)
    for (const WorkPoint& p : line.points) {
      std::string end = p.failure.empty() ? kReached : oneLine(p.failure);
      std::replace(end.begin(), end.end(), ',', ';');
      csv += fmt::format("{},{},{:.3f},{:.9g},{},{:.4g},{:.4g},{:.4g},{}\n", line.method,
                         line.order, line.observed_order, p.step, p.calls,
                         std::isfinite(p.seconds) ? p.seconds : 0.0, p.error, p.energy_error, end);
    }
  return csv;
}

std::string workScript(const WorkPrecision& work, const std::string& name,
                       const std::string& style) {
  Range errors, energies, calls, seconds;
  bool fails = false;
  std::string left_out;
  constexpr int kNamesThatFit = 3;
  int are_left_out = 0;
  for (const WorkLine& line : work.lines) {
    if (!line.left_out.empty()) {
      ++are_left_out;
      left_out += (left_out.empty() ? "" : ", ") + line.method;
    }
    for (const WorkPoint& p : line.points) {
      fails = fails || !p.failure.empty();
      if (std::isfinite(p.seconds)) seconds.take(p.seconds);
      calls.take(static_cast<double>(p.calls));
      if (!p.failure.empty()) continue;
      errors.take(p.error);
      energies.take(p.energy_error);
    }
  }
  if (are_left_out > kNamesThatFit)
    left_out = fmt::format("{} methods, the reasons are in the data", are_left_out);
  const std::string title = work.title.empty() ? work.scene : work.title;
  std::string text = fmt::format(
      "# Work and precision of simulations of {0}. Draw again with:  gnuplot {1}.gp\n"
      "load '{2}'\n"
      "eval canvas(1200, 1000, 16)\n"
      "set output picture_file('{1}')\n"
      "set multiplot\n"
      "set label 1 {3} at screen 0.5, screen 0.975 center textcolor rgb ink font ',20'\n"
      "set label 2 {4} at screen 0.5, screen 0.03 center textcolor rgb soft font ',13'\n"
      "set label 3 {5} at screen 0.5, screen 0.01 center textcolor rgb soft font ',13'\n"
      "set logscale xy\nset format x '1e%T'\nset format y '1e%T'\nunset mxtics\nunset mytics\n"
      "seen(error) = error > border ? error : border\n",
      oneLine(work.scene), name, style,
      gnuplotString(fmt::format("{}, {} s: lower left is better", title, work.duration)),
      gnuplotString("reference: " + referenceText(work.reference)),
      gnuplotString(fmt::format(
          "order seen (and by theory), no range: none is asymptotic; {}{}{}",
          fails ? "crossed out at the right border: failed, the reason is in the data; " : "",
          left_out.empty() ? "" : "left out: " + left_out + "; ", work.machine)));
  struct Panel {
    const Range &error, &cost;
    int error_column, cost_column;
    const char *x, *y;
  };
  const Panel panels[] = {
      {errors, calls, 7, 5, "error of the end  [rad, m, rad/s, m/s]", "calls of the equations"},
      {energies, calls, 8, 5, "energy error / largest kinetic energy  [1]", ""},
      {errors, seconds, 7, 6, "error of the end  [rad, m, rad/s, m/s]", "CPU time  [s]"},
      {energies, seconds, 8, 6, "energy error / largest kinetic energy  [1]", ""}};
  for (int k = 0; k < 4; ++k) {
    const Panel& p = panels[k];
    const double left = p.error.high < p.error.low ? -17 : std::floor(p.error.low) - 1,
                 right =
                     p.error.high < p.error.low ? 0 : std::min(std::ceil(p.error.high), 6.0) + 2;
    const double top = k < 2 ? 0.945 : 0.585;
    text += fmt::format(
        "{0}set lmargin at screen {1}\nset rmargin at screen {2}\n"
        "set tmargin at screen {3}\nset bmargin at screen {4}\n"
        "border = 1e{5:.0f}\nfailed = 10**{6:.2f}\nset xrange [1e{5:.0f}:1e{7:.0f}]\n"
        "set xtics 1e{5:.0f},1e{8:.0f}\nset yrange [{9:.4g}:{10:.4g}]\n"
        "set xlabel '{11}'\nset ylabel '{12}'\n",
        k == 1 ? "unset label\n" : "", k % 2 == 0 ? 0.085 : 0.57, k % 2 == 0 ? 0.5 : 0.985, top,
        top - 0.275, left, right - 0.5, right, std::max(1.0, std::ceil((right - left) / 7)),
        std::pow(10, p.cost.low - 0.3), std::pow(10, p.cost.high + 0.3), p.x, p.y);
    if (k == 0) {
      constexpr std::size_t kThreeFit = 26;  // letters of a name, three to a row
      constexpr int kNarrower = -11;  // letters less than gnuplot reserves, which are wide ones
      int drawn = 0;
      std::size_t longest = 0;
      for (const WorkLine& line : work.lines) {
        if (line.points.empty()) continue;
        ++drawn;
        longest = std::max(longest, line.method.size());
      }
      const int columns = longest > kThreeFit ? 2 : 3;
      text += fmt::format(
          "set key at screen 0.5, screen 0.145 center center vertical Left reverse samplen 4 "
          "maxrows {} width {} font ',14'\n",
          (drawn + columns - 1) / columns, columns == 2 ? kNarrower : 0);
    } else {
      text += "unset key\n";
    }
    text += panel(work, name + ".csv", p.error_column, p.cost_column, k == 0);
  }
  return text + "unset multiplot\nunset output\n";
}

}  // namespace dynwitness::crosscheck
