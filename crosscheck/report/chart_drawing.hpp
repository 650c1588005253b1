// SPDX-License-Identifier: GPL-3.0-or-later
// A chart as data, and as a gnuplot script that draws it from the data.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/chart/chart.hpp"

namespace dynwitness::crosscheck {

/// Charts of one scene as one table, under `#` lines that say what was measured and on which
/// machine:
/// `quantity,method,scalar,error_worst,error_median,time_min_ns,time_median_ns,time_high_ns`.
std::string chartCsv(const std::vector<Chart>& charts);

/** Draws NAME.svg from NAME.csv beside it.
    @param style  the path of style.gp, as seen from the script's folder */
std::string chartScript(const Chart& chart, const std::string& name, const std::string& style);

}  // namespace dynwitness::crosscheck
