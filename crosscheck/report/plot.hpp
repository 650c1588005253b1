// SPDX-License-Identifier: GPL-3.0-or-later
// Charts: the data as CSV first, then a gnuplot script that anyone can run again, then its
// pictures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// Colour and marker of a witness that is an outside engine, the same in every chart: a line type
/// of style.gp. Nothing: it is none that has one.
std::optional<int> lineTypeOfEngine(const std::string& witness);

/// Every point of the paths: `step_s,time_s,energy_error_over_scale`, under `#` lines with scene,
/// method and scale.
std::string driftCsv(const SceneResult& scene);

/// One line a path: `step_s,worst_energy_error_over_scale`.
std::string driftWorstCsv(const SceneResult& scene);

/// Draws drift.svg from drift.csv and drift_worst.csv beside it; it loads
/// ../style.gp. Empty when no path has an error above zero: there is nothing to see on a log axis.
std::string driftScript(const SceneResult& scene);

/// How pictures are written: variables of style.gp.
struct PictureLook {
  std::string kind = "svg";  ///< or png, pdf: the ending of the files, too
  std::string paper = "";    ///< "white", "transparent"; "": as the kind is by itself
};

/// Draws methods.svg (or .png, .pdf) of several methods' drifts from methods.csv beside it, whose
/// columns are method, step and worst error over scale: worst error against step, a line a method;
/// it loads style.gp. Empty when no path has an error above zero.
std::string driftsScript(const std::string& title, const std::vector<Drift>& drifts);
/// Its table. "method,step_s,worst_energy_error_over_scale"
std::string driftsCsv(const std::vector<Drift>& drifts);

/// The same of methods with one step each, against time: whether an energy error stays within
/// bounds or runs away.
std::string driftsAlongScript(const std::string& title, const std::vector<Drift>& drifts);
/// Its table, the largest of each stretch. "method,time_s,energy_error_over_scale"
std::string driftsAlongCsv(const std::vector<Drift>& drifts);
/// Whether each has one path, of one step.
bool haveOneStepEach(const std::vector<Drift>& drifts);

/** Runs gnuplot on a script in its folder, without a shell. An SVG gets rules of CSS for dark
    pages, unless it stands on white: one picture for both.

    @param pictures  that the script draws, with the ending of `look`
    @return nothing when every file of `pictures` was drawn to its end, else why not (unfinished
            pictures are removed) */
std::optional<std::string> runGnuplot(const std::filesystem::path& folder,
                                      const std::string& script,
                                      const std::vector<std::string>& pictures,
                                      const PictureLook& look = {});

}  // namespace dynwitness::crosscheck
