// SPDX-License-Identifier: GPL-3.0-or-later
// Charts as files of the user's folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace dynwitness::cli {

/// Beside the scripts, named so that it meets no file of the user's.
inline constexpr const char* kChartStyle = "dynwitness_style.gp";

/// STEM.csv, and STEM.gp, which loads kChartStyle and draws STEM.svg and STEM_dark.svg.
struct ChartFiles {
  std::string stem, csv, script;
};

/** Data, script and pictures of each chart, with the style. A picture that gnuplot does not finish
    is named, and leaves its data and script all the same.
    @throws std::runtime_error  there is such a picture, or a file cannot be written */
void writeCharts(const std::vector<ChartFiles>& charts, const std::filesystem::path& folder);

}  // namespace dynwitness::cli
