// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/evaluate_picture.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/report/assets.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/error.hpp"

namespace dynwitness::cli {

int timeAmong(const std::vector<std::string>& columns, const std::string& file) {
  for (const char* name : {"t", "time", "time_s"}) {
    const auto found = std::find(columns.begin(), columns.end(), name);
    if (found != columns.end()) return static_cast<int>(found - columns.begin());
  }
  throw scene::InputError(
      {file, 0},
      "--format svg, png or pdf without a column of time, allowed: t, time or time_s [s]");
}

void drawTrajectory(const std::filesystem::path& csv, const std::string& title,
                    const std::string& about, int time,
                    const std::vector<crosscheck::TrajectoryLine>& lines, const std::string& output,
                    const crosscheck::PictureLook& look) {
  const std::filesystem::path folder = csv.parent_path();
  const std::string script = crosscheck::trajectoryScript(title, about, time + 1, lines,
                                                          csv.filename().string(), "motion");
  const std::string picture_file = "motion." + look.kind;
  crosscheck::writeWholeFile(folder / "style.gp", crosscheck::kStyleGnuplot);
  crosscheck::writeWholeFile(folder / "motion.gp", script);
  if (const auto failure = crosscheck::runGnuplot(folder, "motion.gp", {picture_file}, look))
    throw std::runtime_error("no picture: " + *failure);
  const std::string picture = finishedPicture(folder / picture_file);
  if (output.empty())
    fmt::print("{}", picture);
  else
    crosscheck::writeWholeFile(output, picture);
}

}  // namespace dynwitness::cli
