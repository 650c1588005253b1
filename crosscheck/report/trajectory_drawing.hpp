// SPDX-License-Identifier: GPL-3.0-or-later
// Quantities along a motion against time, a panel a quantity and unit.
#pragma once

#include <string>
#include <vector>

namespace dynwitness::crosscheck {

/// A column of numbers of a CSV table.
struct TrajectoryLine {
  std::string quantity;  ///< lines of one quantity and unit share a panel
  std::string name;      ///< "tau2"
  std::string unit;      ///< "N m"; "": none is known
  int column;            ///< from 1
};

/// Most lines a panel: those of a quantity that has more go on in the next.
inline constexpr std::size_t kMostTrajectoryLines = 8;
/// Most panels of a picture.
inline constexpr std::size_t kMostTrajectoryPanels = 12;

/** A gnuplot script that draws STEM.svg (or .png, .pdf) from CSV beside it, and loads style.gp.

    Where kinetic and potential energy are both there, their sum is drawn, too; where the residual
    of the equations of motion is, its panel is of what is left, with 0 as a line.
    @param time   the column of time [s], from 1
    @param about  a line below the title
    @throws scene::InputError  more than kMostTrajectoryPanels */
std::string trajectoryScript(const std::string& title, const std::string& about, int time,
                             const std::vector<TrajectoryLine>& lines, const std::string& csv,
                             const std::string& stem);

}  // namespace dynwitness::crosscheck
