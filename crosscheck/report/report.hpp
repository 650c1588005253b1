// SPDX-License-Identifier: GPL-3.0-or-later
// The report: a folder that opens offline.
//
//     index.html                       what people read first: verdict, scenes, witnesses
//     scenes/SCENE/index.html          a scene's equations, checks, digits, motions, drift, charts
//     report.json, junit.xml           what programs read
//     digits.md                        correct digits: a table a quantity
//     contents.txt                     which files of the folder are the report's
//     scenes/style.gp                  the looks of the charts
//     scenes/SCENE/tree.svg            the mechanism
//     scenes/SCENE/view.html           its picture, which moves
//     scenes/SCENE/drift.csv, drift_worst.csv, drift.gp, drift.svg
//     scenes/SCENE/speed.csv, speed.gp, speed.svg
//     bench/bench.csv, bench.gp, bench.svg
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "crosscheck/chart/chart.hpp"
#include "crosscheck/inputs/feature_pairs.hpp"
#include "crosscheck/report/bench.hpp"
#include "crosscheck/system/environment.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/** Writes the report into `folder`, whole or not at all; an earlier report there is replaced, and
    files of anybody else stay. The same result, environment and charts give the same bytes.

    @param charts  speed against accuracy, none or one a scene. Times differ from run to run, so
      they are apart from the result, and only in scenes/SCENE/speed*
    @param bench   what a run of the benchmarks measured, for the section "Speed"; none: no section
    @param views   pages of pictures (showPage), none or one a scene; an empty one is left out
    @param pairs   of features, of the scenes together, for a section of their own; none: no section
    @param atlas   atlasSection(); may be empty
    @param models  modelSections(), by the scene's name; may be empty
    @throws scene::InputError   as requireWritable(), before any work
    @throws std::runtime_error  writing failed (disk full, ...); the folder is as it was before */
void writeReport(const CrosscheckResult& result, const Environment& environment,
                 const std::filesystem::path& folder, const std::vector<Chart>& charts = {},
                 const BenchResult* bench = nullptr, const std::vector<std::string>& views = {},
                 const PairTable* pairs = nullptr, const std::string& atlas = {},
                 const std::map<std::string, std::string>& models = {});

/** Writes bench.csv, bench.gp and, where gnuplot can, the pictures, and says where they are
    relative to `folder`.
    @param name   of their folder in it; empty: `folder` itself
    @param style  the path of style.gp, as seen from there */
BenchFiles writeBenchChart(const BenchResult& bench, const UnfinishedFolder& folder,
                           const std::string& name, const std::string& style);

}  // namespace dynwitness::crosscheck
