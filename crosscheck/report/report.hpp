// SPDX-License-Identifier: GPL-3.0-or-later
// The report: a folder that opens offline.
//
//     index.html                       what people read
//     report.json, junit.xml           what programs read
//     digits.md                        correct digits: a table a quantity
//     contents.txt                     which files of the folder are the report's
//     scenes/style.gp                  the looks of the charts
//     scenes/SCENE/tree.svg            the mechanism
//     scenes/SCENE/drift.csv, drift_worst.csv, drift.gp, drift.svg, drift_dark.svg
//     scenes/SCENE/speed.csv, speed.gp, speed.svg, speed_dark.svg
#pragma once

#include <filesystem>
#include <vector>

#include "crosscheck/chart/chart.hpp"
#include "crosscheck/report/environment.hpp"
#include "crosscheck/report/files.hpp"
#include "crosscheck/result.hpp"

namespace dynwitness::crosscheck {

/** Writes the report into `folder`, whole or not at all; an earlier report there is replaced, and
    files of anybody else stay. The same result, environment and charts give the same bytes.

    @param charts  speed against accuracy, none or one a scene. Times differ from run to run, so they
                   are apart from the result, and only in scenes/SCENE/speed*
    @throws scene::InputError   as requireWritable(), before any work
    @throws std::runtime_error  writing failed (disk full, ...); the folder is as it was before */
void writeReport(const CrosscheckResult& result, const Environment& environment,
                 const std::filesystem::path& folder, const std::vector<Chart>& charts = {});

}  // namespace dynwitness::crosscheck
