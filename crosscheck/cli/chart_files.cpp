// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/chart_files.hpp"

#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "crosscheck/cli/options.hpp"
#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {

using namespace crosscheck;
namespace fs = std::filesystem;

std::string chartScript(const scene::Scene& scene, const std::string& title,
                        const std::string& stem, const std::string& body) {
  return fmt::format(
      "# Draw again with:  gnuplot {0}.gp\n"
      "load '{1}'\n"
      "eval canvas(900, 600, 16)\n"
      "set output picture_file('{0}')\n"
      "set datafile separator ','\n"
      "set title {2} textcolor rgb ink\n"
      "{3}"
      "unset output\n",
      stem, kChartStyle,
      gnuplotString(oneLine(scene.title.empty() ? scene.name : scene.title) + ": " + title), body);
}

void writeCharts(const std::vector<ChartData>& data, const std::vector<ChartScript>& scripts,
                 const fs::path& folder, const PictureLook& look) {
  const UnfinishedFolder work(folder);  // vanishes again
  work.write(kChartStyle, kStyleGnuplot);
  std::vector<std::string> files = {kChartStyle};
  std::string problem;
  for (const auto& [stem, csv] : data) {
    work.write(stem + ".csv", csv);
    files.push_back(stem + ".csv");
  }
  for (const auto& [stem, script] : scripts) {
    const std::string picture = stem + "." + look.kind;
    work.write(stem + ".gp", script);
    files.push_back(stem + ".gp");
    if (const auto failure = runGnuplot(work.path(), stem + ".gp", {picture}, look))
      problem = *failure;
    else
      files.push_back(picture);
  }
  fs::create_directories(folder);
  for (const std::string& file : files) {
    std::ifstream stream(work.path() / file, std::ios::binary);
    writeWholeFile(folder / file, std::string(std::istreambuf_iterator<char>(stream), {}));
  }
  if (!problem.empty())
    throw std::runtime_error(
        fmt::format("no picture: {}; data and scripts are in {}", problem, folder.string()));
}

void addPictures(CLI::App& command, PictureLook& look) {
  command.add_option("--format", look.kind, "How it is written: the pictures")
      ->capture_default_str()
      ->check(oneOf({"svg", "png", "pdf"}));
  addBackground(command, look);
}

void addBackground(CLI::App& command, PictureLook& look) {
  command
      .add_option(
          "--background", look.paper,
          "What pictures stand on; without: SVG and PDF on nothing, PNG on white. An SVG on "
          "nothing is for light and dark pages: its colours follow the viewer's")
      ->check(oneOf({"white", "transparent"}));
}

PictureLook lookOfFile(const std::filesystem::path& file, PictureLook look) {
  const std::string ending = file.extension().string();
  if (ending.empty()) return look;  // SVG, as it always was
  if (ending != ".svg" && ending != ".png" && ending != ".pdf")
    throw scene::InputError(
        {}, fmt::format("--plot: read '{}', allowed: a file that ends in .svg, .png or .pdf",
                        file.string()));
  look.kind = ending.substr(1);
  return look;
}

std::string finishedPicture(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void drawTo(const std::filesystem::path& file, const std::filesystem::path& folder,
            const std::string& stem, const PictureLook& look) {
  const std::string picture = stem + "." + look.kind;
  if (const auto failure = runGnuplot(folder, stem + ".gp", {picture}, look))
    throw std::runtime_error("chart: " + *failure);
  writeWholeFile(file, finishedPicture(folder / picture));
}

}  // namespace dynwitness::cli
