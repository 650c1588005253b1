// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness evaluate --format svg|png|pdf: a motion's quantities against time.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/trajectory_drawing.hpp"

namespace dynwitness::cli {

/// The place of the time among the columns that a file of states has beside states, from 0.
/// @throws scene::InputError  there is none: t, time, or time_s
int timeAmong(const std::vector<std::string>& columns, const std::string& file);

/** Draws a table.
    @param csv     the table, in a folder of its own, which gets style.gp and the script
    @param output  the picture; "": standard output
    @throws std::runtime_error  gnuplot did not finish it, or a file cannot be written */
void drawTrajectory(const std::filesystem::path& csv, const std::string& title,
                    const std::string& about, int time,
                    const std::vector<crosscheck::TrajectoryLine>& lines, const std::string& output,
                    const crosscheck::PictureLook& look);

}  // namespace dynwitness::cli
