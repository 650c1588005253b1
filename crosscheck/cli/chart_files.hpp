// SPDX-License-Identifier: GPL-3.0-or-later
// Charts as files of the user's folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "crosscheck/report/plot.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

/// Beside the scripts, named so that it meets no file of the user's.
inline constexpr const char* kChartStyle = "dynwitness_style.gp";

/// STEM.csv of data, which scripts read.
struct ChartData {
  std::string stem, csv;
};
/// STEM.gp, which loads kChartStyle and draws STEM.svg, .png or .pdf.
struct ChartScript {
  std::string stem, script;
};

/** A script of one chart of 900 x 600 from STEM.csv.
    @param title  beside the scene's
    @param body   axes and the plot, in lines of their own */
std::string chartScript(const scene::Scene& scene, const std::string& title,
                        const std::string& stem, const std::string& body);

/** Data, scripts and pictures, with the style. A picture that gnuplot does not finish is named, and
    leaves data and script all the same.
    @throws std::runtime_error  there is such a picture, or a file cannot be written */
void writeCharts(const std::vector<ChartData>& data, const std::vector<ChartScript>& scripts,
                 const std::filesystem::path& folder, const crosscheck::PictureLook& look = {});

/// The look of the picture that --plot asks for, whose kind its ending says.
/// @throws scene::InputError  another ending
crosscheck::PictureLook lookOfFile(const std::filesystem::path& file, crosscheck::PictureLook look);
/// The bytes of a drawn picture.
std::string finishedPicture(const std::filesystem::path& file);
/// Draws STEM.gp of a folder, which makes STEM.svg, .png or .pdf there.
/// @throws std::runtime_error  gnuplot does not finish it
void drawTo(const std::filesystem::path& file, const std::filesystem::path& folder,
            const std::string& stem, const crosscheck::PictureLook& look);

/// --format svg|png|pdf of pictures, and --background.
void addPictures(CLI::App& command, crosscheck::PictureLook& look);
/// --background alone, where a file's ending says the format.
void addBackground(CLI::App& command, crosscheck::PictureLook& look);

}  // namespace dynwitness::cli
