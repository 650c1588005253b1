// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/chart_files.hpp"

#include <fstream>
#include <iterator>
#include <regex>

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
      "do for [dark = 0:1] {{\n"
      "load '{1}'\n"
      "eval canvas(900, 600, 16)\n"
      "set output picture_file('{0}')\n"
      "set datafile separator ','\n"
      "set title {2} textcolor rgb ink\n"
      "{3}"
      "unset output\nreset\n}}\n",
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
    const std::vector<std::string> pictures = {stem + "." + look.kind, stem + "_dark." + look.kind};
    work.write(stem + ".gp", script);
    files.push_back(stem + ".gp");
    if (const auto failure = runGnuplot(work.path(), stem + ".gp", pictures, look))
      problem = *failure;
    else
      files.insert(files.end(), pictures.begin(), pictures.end());
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
      .add_option("--background", look.paper,
                  "What pictures stand on; without: SVG and PDF on nothing, PNG on white (the dark "
                  "ones on dark)")
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

namespace {

/// Rules of CSS that give each colour of style.gp its dark one.
std::string darkRules() {
  static const std::regex kPair("dark \\? '#([0-9a-f]{6})' : '#([0-9a-f]{6})'");
  const std::string style(kStyleGnuplot);
  std::string rules;
  for (std::sregex_iterator it(style.begin(), style.end(), kPair), end; it != end; ++it) {
    const std::string dark = (*it)[1], light = (*it)[2];
    const unsigned long rgb = std::stoul(light, nullptr, 16);
    const auto red = rgb >> 16, green = (rgb >> 8) & 255, blue = rgb & 255;
    for (const std::string& as : {fmt::format("rgb({},{},{})", red, green, blue),
                                  fmt::format("rgb({:3}, {:3}, {:3})", red, green, blue)})
      for (const char* what : {"stroke", "fill"})
        rules += fmt::format("[{0}=\"{1}\"] {{ {0}: #{2} }}\n", what, as, dark);
  }
  return rules;
}

}  // namespace

std::string finishedPicture(const std::filesystem::path& file, const PictureLook& look) {
  std::ifstream stream(file, std::ios::binary);
  std::string picture(std::istreambuf_iterator<char>(stream), {});
  const std::size_t begin = picture.find("<svg");
  if (look.kind != "svg" || look.paper == "white" || begin == std::string::npos) return picture;
  picture.insert(picture.find('>', begin) + 1,
                 "\n<style>@media (prefers-color-scheme: dark) {\n" + darkRules() + "}</style>");
  return picture;
}

void drawTo(const std::filesystem::path& file, const std::filesystem::path& folder,
            const std::string& stem, const std::vector<std::string>& pictures,
            const PictureLook& look) {
  if (const auto failure = runGnuplot(folder, stem + ".gp", pictures, look))
    throw std::runtime_error("chart: " + *failure);
  writeWholeFile(file, finishedPicture(folder / pictures.front(), look));
}

}  // namespace dynwitness::cli
