// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/trajectory_drawing.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/report/text.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr const char* kKinetic = "kinetic";
constexpr const char* kPotential = "potential";

using Panel = std::vector<TrajectoryLine>;

/// Energies are one panel, whose sum says whether they are exchanged.
std::string panelOf(const TrajectoryLine& line) {
  const bool is_energy = line.quantity == kKinetic || line.quantity == kPotential;
  return (is_energy ? "energy" : line.quantity) + "|" + line.unit;
}

std::vector<Panel> panelsOf(const std::vector<TrajectoryLine>& lines) {
  std::vector<Panel> panels;
  for (const TrajectoryLine& line : lines) {
    const auto panel = std::find_if(panels.begin(), panels.end(), [&](const Panel& p) {
      return panelOf(p.front()) == panelOf(line) && p.size() < kMostTrajectoryLines;
    });
    if (panel == panels.end())
      panels.push_back({line});
    else
      panel->push_back(line);
  }
  return panels;
}

int columnOf(const Panel& panel, const char* quantity) {
  for (const TrajectoryLine& line : panel)
    if (line.quantity == quantity) return line.column;
  return 0;
}

std::string panelText(const Panel& panel, int time, const std::string& csv) {
  const int kinetic = columnOf(panel, kKinetic), potential = columnOf(panel, kPotential);
  const bool is_energy = kinetic > 0 || potential > 0;
  const std::string quantity = is_energy ? "energy" : panel.front().quantity;
  std::string text = fmt::format(
      "set ylabel {}\nplot ",
      gnuplotString(panel.front().unit.empty() ? quantity
                                               : quantity + "  [" + panel.front().unit + "]"));
  int type = 0;
  for (const TrajectoryLine& line : panel)
    text += fmt::format("{}'{}' using {}:{} with lines linetype {} title {}",
                        type > 0 ? ", \\\n     " : "", csv, time, line.column, type + 1,
                        gnuplotString(line.name)),
        ++type;
  if (kinetic > 0 && potential > 0)
    text += fmt::format(", \\\n     '{}' using {}:(${} + ${}) with lines linetype {} title 'sum'",
                        csv, time, kinetic, potential, type + 1);
  return text + "\n";
}

}  // namespace

std::string trajectoryScript(const std::string& title, const std::string& about, int time,
                             const std::vector<TrajectoryLine>& lines, const std::string& csv,
                             const std::string& stem) {
  const std::vector<Panel> panels = panelsOf(lines);
  if (panels.size() > kMostTrajectoryPanels)
    throw scene::InputError(
        {}, fmt::format("{} numbers in {} panels, allowed in a picture: {} panels of at most {} "
                        "lines; ask for fewer quantities, joints or points",
                        lines.size(), panels.size(), kMostTrajectoryPanels, kMostTrajectoryLines));
  constexpr int kHead = 90, kPanel = 240, kFoot = 60;  // pixels
  const double height = kHead + kPanel * static_cast<double>(panels.size()) + kFoot;
  std::string text = fmt::format(
      "load 'style.gp'\n"
      "eval canvas(1000, {:.0f}, 13)\n"
      "set output picture_file('{}')\nset multiplot\n"
      "set label 1 {} at screen 0.5, screen {:.4f} center textcolor rgb ink font ',17'\n"
      "set label 2 {} at screen 0.5, screen {:.4f} center textcolor rgb soft font ',12'\n"
      "set lmargin at screen 0.1\nset rmargin at screen 0.86\n"
      "set key at screen 0.87, graph 1 left top Left reverse samplen 2\n"
      "set format x ''\nset xzeroaxis linetype 20\n",
      height, stem, gnuplotString(title), 1 - 26 / height, gnuplotString(about), 1 - 50 / height);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const double top = height - kHead - kPanel * static_cast<double>(k);
    text += fmt::format("set tmargin at screen {:.4f}\nset bmargin at screen {:.4f}\n",
                        top / height, (top - kPanel + 22) / height);
    if (k + 1 == panels.size()) text += "set format x '%g'\nset xlabel 'time  [s]'\n";
    text += panelText(panels[k], time, csv);
    if (k == 0) text += "unset label 1\nunset label 2\n";
  }
  return text + "unset multiplot\nunset output\n";
}

}  // namespace dynwitness::crosscheck
