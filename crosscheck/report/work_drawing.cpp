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

/// Which lines are drawn together: more than some ten in a panel are not told apart without colour.
enum class Family { kExplicit, kImplicit };
constexpr Family kEx = Family::kExplicit, kIm = Family::kImplicit;

/// Colour and dashes, and mark of a method: line type and point type of style.gp, the same in every
/// chart. No two lines of a family have the same mark.
struct Look {
  int line, point;
  Family family;
};
Look lookOf(const std::string& method) {
  static const std::map<std::string, Look> looks = {
      {"euler", {2, 11, kEx}},
      {"semi_implicit_euler", {2, 4, kIm}},
      {"implicit_euler", {2, 12, kIm}},
      {"modified_midpoint", {1, 9, kEx}},
      {"runge_kutta4", {1, 7, kEx}},
      {"runge_kutta_dopri5", {1, 5, kEx}},
      {"runge_kutta_fehlberg78", {1, 13, kEx}},
      {"bulirsch_stoer8", {6, 6, kEx}},
      {"adams_bashforth_moulton4", {6, 8, kEx}},
      {"lie_runge_kutta4", {6, 14, kEx}},
      {"stormer_verlet", {3, 9, kIm}},
      {"implicit_midpoint", {3, 7, kIm}},
      {"gauss_4", {3, 5, kIm}},
      {"gauss_6", {3, 13, kIm}},
      {"rosenbrock4", {5, 15, kIm}},
      {"radau_iia_3", {4, 8, kIm}},
      {"radau_iia_5", {4, 10, kIm}},
      // of closed mechanisms
      {"semi_implicit_euler projection", {2, 4, kEx}},
      {"runge_kutta4 index1", {1, 9, kEx}},
      {"runge_kutta4 baumgarte", {1, 11, kEx}},
      {"runge_kutta4 projection", {1, 7, kEx}},
      {"runge_kutta_dopri5 projection", {1, 5, kEx}},
      {"runge_kutta_fehlberg78 projection", {1, 13, kEx}},
      {"bulirsch_stoer8 projection", {6, 6, kEx}},
      {"gauss_6 projection", {3, 13, kIm}},
      {"implicit_euler index2", {2, 12, kIm}},
      {"radau_iia_3 index2", {5, 8, kIm}},
      {"radau_iia_5 projection", {4, 10, kIm}},
      {"radau_iia_5 index2", {4, 14, kIm}},
      {"radau_iia_5 index3", {4, 9, kIm}},
      {"radau_iia_5 ggl", {4, 5, kIm}},
  };
  const auto found = looks.find(method);
  return found == looks.end() ? Look{16, 3, Family::kImplicit} : found->second;
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

bool isOf(Family family, const WorkLine& line) {
  return !line.points.empty() && lookOf(line.method).family == family;
}

/// The lines of a family, and faint those of the other.
std::string panel(const WorkPrecision& work, const std::string& csv, Family family,
                  int error_column, int cost_column, bool with_key) {
  std::string text = "plot ";
  const auto next = [&] { return text == "plot " ? "" : ", \\\n     "; };
  const auto mine = [](const WorkLine& line) {
    return fmt::format("strcol(1) eq {}", gnuplotString(line.method));
  };
  for (const WorkLine& line : work.lines)
    if (!line.points.empty() && !isOf(family, line))
      text += next() +
              fmt::format(
                  "'{}' using ({} && strcol(9) eq '{}' ? seen(${}) : NaN):{} with lines linetype 1 "
                  "linecolor rgb faint notitle",
                  csv, mine(line), kReached, error_column, cost_column);
  for (const WorkLine& line : work.lines) {
    if (!isOf(family, line)) continue;
    const Look look = lookOf(line.method);
    text +=
        next() + fmt::format(
                     "'{}' using ({} && strcol(9) eq '{}' ? seen(${}) : NaN):{} with linespoints "
                     "linetype {} pointtype {} {}",
                     csv, mine(line), kReached, error_column, cost_column, look.line, look.point,
                     with_key ? "title " + gnuplotString(fmt::format("{}: {} ({})", line.method,
                                                                     orderText(line.observed_order),
                                                                     line.order))
                              : std::string("notitle"));
    const bool fails = std::any_of(line.points.begin(), line.points.end(),
                                   [](const WorkPoint& p) { return !p.failure.empty(); });
    if (fails)
      text += fmt::format(
          ", \\\n     '{0}' using ({1} && strcol(9) ne '{2}' ? failed : NaN):{3} with points linetype "
          "{4} pointtype {5} notitle, \\\n     '{0}' using ({1} && strcol(9) ne '{2}' ? failed : "
          "NaN):{3} with points linetype {4} pointtype 2 pointsize 1.4 notitle",
          csv, mine(line), kReached, cost_column, look.line, look.point);
  }
  return text + "\n";
}

/// Heights of the picture's parts, in its points.
constexpr int kHead = 60, kPanel = 270, kBelowPanel = 90, kKeyRow = 22, kBelowKey = 30, kFoot = 60;

/// Names in columns of one key.
struct Key {
  int rows = 0, columns = 3;
  int narrower = 0;  ///< by so many letters than gnuplot reserves, which are wide ones
};
Key keyOf(const WorkPrecision& work, Family family) {
  constexpr std::size_t kThreeFit = 26,
                        kOrders = 14;  // letters of a name, three to a row; ": no range (4)"
  int drawn = 0;
  std::size_t longest = 0;
  for (const WorkLine& line : work.lines) {
    if (!isOf(family, line)) continue;
    ++drawn;
    longest = std::max(longest, line.method.size());
  }
  Key key;
  key.columns = longest > kThreeFit ? 2 : 3;
  key.rows = (drawn + key.columns - 1) / key.columns;
  key.narrower = -static_cast<int>(longest + kOrders) / 4;
  return key;
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
  std::vector<Family> families;
  int height = kHead + kFoot;
  for (const Family family : {Family::kExplicit, Family::kImplicit})
    if (const Key key = keyOf(work, family); key.rows > 0) {
      families.push_back(family);
      height += 2 * (kPanel + kBelowPanel) + key.rows * kKeyRow + kBelowKey;
    }
  const std::string title = work.title.empty() ? work.scene : work.title;
  std::string text = fmt::format(
      "# Work and precision of simulations of {0}. Draw again with:  gnuplot {1}.gp\n"
      "load '{2}'\n"
      "eval canvas(1200, {6}, 16)\n"
      "set output picture_file('{1}')\n"
      "set multiplot\n"
      "set label 1 {3} at screen 0.5, screen {7:.5f} center textcolor rgb ink font ',20'\n"
      "set label 2 {4} at screen 0.5, screen {8:.5f} center textcolor rgb soft font ',13'\n"
      "set label 3 {5} at screen 0.5, screen {9:.5f} center textcolor rgb soft font ',13'\n"
      "set logscale xy\nset format x '1e%T'\nset format y '1e%T'\nunset mxtics\nunset mytics\n"
      "seen(error) = error > border ? error : border\n",
      oneLine(work.scene), name, style,
      gnuplotString(fmt::format("{}, {} s: lower left is better", title, work.duration)),
      gnuplotString("reference: " + referenceText(work.reference)),
      gnuplotString(fmt::format(
          "order seen (and by theory), no range: none is asymptotic; {}{}{}",
          fails ? "crossed out at the right border: failed, the reason is in the data; " : "",
          left_out.empty() ? "" : "left out: " + left_out + "; ", work.machine)),
      height, 1 - 25.0 / height, 30.0 / height, 10.0 / height);
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
  double top = kHead;  // of what comes next, from above
  const auto onScreen = [&](double from_above) { return 1 - from_above / height; };
  for (const Family family : families) {
    const Key key = keyOf(work, family);
    for (int k = 0; k < 4; ++k) {
      const Panel& p = panels[k];
      const double left = p.error.high < p.error.low ? -17 : std::floor(p.error.low) - 1,
                   right =
                       p.error.high < p.error.low ? 0 : std::min(std::ceil(p.error.high), 6.0) + 2;
      const double from = top + (k < 2 ? 0 : kPanel + kBelowPanel);
      text += fmt::format(
          "set lmargin at screen {0}\nset rmargin at screen {1}\n"
          "set tmargin at screen {2:.5f}\nset bmargin at screen {3:.5f}\n"
          "border = 1e{4:.0f}\nfailed = 10**{5:.2f}\nset xrange [1e{4:.0f}:1e{6:.0f}]\n"
          "set xtics 1e{4:.0f},1e{7:.0f}\nset yrange [{8:.4g}:{9:.4g}]\n"
          "set xlabel '{10}'\nset ylabel '{11}'\n",
          k % 2 == 0 ? 0.085 : 0.57, k % 2 == 0 ? 0.5 : 0.985, onScreen(from),
          onScreen(from + kPanel), left, right - 0.5, right,
          std::max(1.0, std::ceil((right - left) / 7)), std::pow(10, p.cost.low - 0.3),
          std::pow(10, p.cost.high + 0.3), p.x, p.y);
      if (k == 0) {
        const double middle = top + 2 * (kPanel + kBelowPanel) + key.rows * kKeyRow / 2.0;
        text += fmt::format(
            "set key at screen 0.5, screen {:.5f} center center vertical Left reverse samplen 4 "
            "maxrows {} width {} font ',14'\n",
            onScreen(middle), key.rows, key.narrower);
      } else {
        text += "unset key\n";
      }
      text += panel(work, name + ".csv", family, p.error_column, p.cost_column, k == 0) +
              "unset label\n";
    }
    top += 2 * (kPanel + kBelowPanel) + key.rows * kKeyRow + kBelowKey;
  }
  return text + "unset multiplot\nunset output\n";
}

}  // namespace dynwitness::crosscheck
