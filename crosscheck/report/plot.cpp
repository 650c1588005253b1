// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/plot.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <regex>
#include <system_error>

#include <fmt/format.h>

#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/report/work_drawing.hpp"
#include "crosscheck/system/children.hpp"

namespace dynwitness::crosscheck {

std::optional<int> lineTypeOfEngine(const std::string& witness) {
  static const std::map<std::string, int> known = {
      {"simbody", 11}, {"mujoco_principal", 12}, {"dart", 13}, {"kdl", 14}, {"mujoco", 15}};
  const auto found = known.find(witness);
  if (found == known.end()) return std::nullopt;
  return found->second;
}

namespace fs = std::filesystem;
namespace {

std::string heading(const SceneResult& scene) {
  const Drift& drift = *scene.drift;
  return fmt::format(
      "# scene: {}\n# method: {}, order {}, observed order {}\n"
      "# energy_error_over_scale: |E - E0| / scale, scale = {} J, the largest kinetic energy along "
      "the finest path\n# duration: {} s\n",
      oneLine(scene.name), oneLine(drift.method), drift.method_order,
      std::isfinite(drift.observed_order) && drift.observed_order > 0
          ? fmt::format("{:.2f}", drift.observed_order)
          : "not seen",
      drift.scale, drift.duration);
}

bool drawable(double error) {
  return std::isfinite(error) && error > 0;
}

/// A picture that was written to its end, by what ends its kind.
bool isWhole(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)),
                         std::istreambuf_iterator<char>());
  const fs::path kind = file.extension();
  return text.find(kind == ".png"   ? "IEND"
                   : kind == ".pdf" ? "%%EOF"
                                    : "</svg>") != std::string::npos;
}

}  // namespace

std::string driftCsv(const SceneResult& scene) {
  std::string csv = heading(scene) + "step_s,time_s,energy_error_over_scale\n";
  for (const Drift::Path& path : scene.drift->paths)
    for (std::size_t i = 0; i < std::min(path.time.size(), path.error.size()); ++i)
      fmt::format_to(std::back_inserter(csv), "{},{},{}\n", path.step, path.time[i], path.error[i]);
  return csv;
}

std::string driftWorstCsv(const SceneResult& scene) {
  std::string csv = heading(scene) + "step_s,worst_energy_error_over_scale\n";
  for (const Drift::Path& path : scene.drift->paths)
    fmt::format_to(std::back_inserter(csv), "{},{}\n", path.step, path.worst);
  return csv;
}

std::string driftScript(const SceneResult& scene) {
  const Drift& drift = *scene.drift;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  double finest = std::numeric_limits<double>::infinity(), coarsest = 0;
  std::vector<const Drift::Path*> seen;
  std::string steps, firsts, lasts;  // of each path, the records in drift.csv
  std::size_t first = 1;             // below the names of the columns
  for (const Drift::Path& path : drift.paths) {
    const char* gap = steps.empty() ? "" : " ";
    const std::size_t points = std::min(path.time.size(), path.error.size());
    steps += fmt::format("{}{}", gap, path.step);
    firsts += fmt::format("{}{}", gap, first);
    lasts += fmt::format("{}{}", gap, first + std::max<std::size_t>(points, 1) - 1);
    first += points;
    if (!drawable(path.worst) || !drawable(path.step)) continue;
    seen.push_back(&path);
    low = std::min(low, path.worst);
    high = std::max(high, path.worst);
    finest = std::min(finest, path.step);
    coarsest = std::max(coarsest, path.step);
  }
  if (seen.empty()) return {};
  // both panels share the range; E crosses E0 now and then, and these dips may leave the picture
  const int bottom = static_cast<int>(std::floor(std::log10(low))) - 2;
  const int top = static_cast<int>(std::ceil(std::log10(high) + 0.1));
  // few labels, whatever the range
  const int every = std::max(1, (top - bottom + 7) / 8);
  // the guide runs beside the points, below them: lower right of the panel is empty
  const double guide = high / 4;

  std::string observed = "worst over the path";
  if (std::isfinite(drift.observed_order) && drift.observed_order > 0)
    observed = fmt::format("worst; observed order {:.2f}", drift.observed_order);
  const std::string title = scene.title.empty() ? scene.name : scene.title;

  // every step is named below the axis as long as there is room
  std::string tics;
  if (seen.size() <= 8)
    for (const Drift::Path* path : seen)
      tics += fmt::format("{}'{:.2g}' {}", tics.empty() ? "" : ", ", path->step, path->step);

  std::string text = fmt::format(
      "# Energy drift of {0}. Draw again with:  gnuplot drift.gp\n"
      "load '../style.gp'\n"
      "set output picture_file('drift')\n"
      "steps = '{1}'; firsts = '{7}'; lasts = '{8}'\n"
      "set multiplot\n"
      "set label 1 {2} at screen 0.5, screen 0.955 center textcolor rgb ink font ',15'\n"
      "set tmargin at screen 0.83\nset bmargin at screen 0.26\n"
      "set logscale y\nset format y '1e%T'\nset yrange [1e{3}:1e{4}]\nset ytics 1e{3},1e{5}\n"
      "unset mytics\n"
      "set ylabel '|E − E₀| / {6:.3g} J  [1]'\n",
      oneLine(scene.name), steps,
      gnuplotString(fmt::format("{}, {}: lower is better", title, drift.method)), bottom, top,
      every, drift.scale, firsts, lasts);
  text += fmt::format(
      "set lmargin at screen 0.09\nset rmargin at screen 0.5\n"
      "set title 'Energy error along the path, for each step size' textcolor rgb soft\n"
      "set xlabel 'time  [s]'\nset xrange [0:{0}]\n"
      "set key at screen 0.295, screen 0.06 center center horizontal Left reverse maxrows 2\n"
      "plot for [i = 1:words(steps)] 'drift.csv' every ::int(word(firsts, i))::int(word(lasts, i)) "
      "using 2:3 with lines linetype i title word(steps, i).' s'\n"
      "unset label\n",
      drift.duration > 0 ? fmt::format("{}", drift.duration) : "*");
  text += fmt::format(
      "set lmargin at screen 0.63\nset rmargin at screen 0.98\n"
      "set title 'Worst error against step size' textcolor rgb soft\n"
      "set xlabel 'step size  [s]'\nset logscale x\nset xrange [{0:.4g}:{1:.4g}]\nset xtics {3}\n"
      "set key at screen 0.805, screen 0.06 center center horizontal Left reverse maxrows 2\n"
      "plot 'drift_worst.csv' using 1:2 with linespoints linetype 1 title {2}",
      finest / 1.6, coarsest * 1.6, gnuplotString(observed),
      tics.empty() ? std::string("auto") : "(" + tics + ")");
  if (drift.method_order > 0)
    text +=
        fmt::format(", \\\n     {:.4g} * (x / {}) ** {} with lines linetype 20 title 'slope {}'",
                    guide, coarsest, drift.method_order, drift.method_order);
  text += "\nunset multiplot\nunset output\n";
  return text;
}

std::string driftsCsv(const std::vector<Drift>& drifts) {
  std::string csv = "method,step_s,worst_energy_error_over_scale\n";
  for (const Drift& drift : drifts)
    for (const Drift::Path& path : drift.paths)
      if (drawable(path.worst))
        csv += fmt::format("{},{},{}\n", drift.method, path.step, path.worst);
  return csv;
}

std::string driftsScript(const std::string& title, const std::vector<Drift>& drifts) {
  std::string plots;
  double finest = std::numeric_limits<double>::infinity(), coarsest = 0;
  for (const Drift& drift : drifts) {
    for (const Drift::Path& path : drift.paths)
      if (drawable(path.worst)) {
        finest = std::min(finest, path.step);
        coarsest = std::max(coarsest, path.step);
      }
    if (std::none_of(drift.paths.begin(), drift.paths.end(),
                     [](const Drift::Path& path) { return drawable(path.worst); }))
      continue;
    const std::string order = std::isfinite(drift.observed_order) && drift.observed_order > 0
                                  ? fmt::format("{:.2f}", drift.observed_order)
                                  : "not seen";
    plots += fmt::format(
        "{}'methods.csv' using (strcol(1) eq {} ? $2 : NaN):3 with linespoints {} title {}",
        plots.empty() ? "" : ", \\\n     ", gnuplotString(drift.method), lookOfMethod(drift.method),
        gnuplotString(fmt::format("{}: order {} ({})", drift.method, order, drift.method_order)));
  }
  if (plots.empty()) return {};
  return fmt::format(
      "load 'style.gp'\n"
      "eval canvas(1000, 560, 13)\n"
      "set output picture_file('methods')\n"
      "set title {} textcolor rgb ink font ',15'\n"
      "set logscale xy\nset format x '%g'\nset format y '1e%T'\nunset mxtics\nunset mytics\n"
      "set xlabel 'step size  [s]'\nset ylabel 'worst |E − E₀| / largest kinetic energy  [1]'\n"
      "set key outside right top Left reverse title 'observed order (its own)'\n"
      "set xrange [{:.4g}:{:.4g}]\n"
      "plot {}\nunset output\n",
      gnuplotString(title + ": lower is better"), finest / 1.6, coarsest * 1.6, plots);
}

bool haveOneStepEach(const std::vector<Drift>& drifts) {
  return std::all_of(drifts.begin(), drifts.end(),
                     [](const Drift& drift) { return drift.paths.size() <= 1; });
}

std::string driftsAlongCsv(const std::vector<Drift>& drifts) {
  std::string csv = "method,time_s,energy_error_over_scale\n";
  for (const Drift& drift : drifts)
    for (const Drift::Path& path : drift.paths)
      for (std::size_t i = 0; i < std::min(path.time.size(), path.error.size()); ++i)
        if (drawable(path.error[i]))
          csv += fmt::format("{},{},{}\n", drift.method, path.time[i], path.error[i]);
  return csv;
}

std::string driftsAlongScript(const std::string& title, const std::vector<Drift>& drifts) {
  std::string plots;
  double duration = 0;
  for (const Drift& drift : drifts)
    for (const Drift::Path& path : drift.paths) {
      if (!drawable(path.worst)) continue;
      duration = std::max(duration, path.end_time);
      plots += fmt::format(
          "{}'methods.csv' using (strcol(1) eq {} ? $2 : NaN):3 with linespoints {} pointinterval "
          "40 title {}",
          plots.empty() ? "" : ", \\\n     ", gnuplotString(drift.method),
          lookOfMethod(drift.method),
          gnuplotString(
              fmt::format("{}: {:.3g} s, at most {:.2g}", drift.method, path.step, path.worst)));
    }
  if (plots.empty()) return {};
  return fmt::format(
      "load 'style.gp'\n"
      "eval canvas(1000, 560, 13)\n"
      "set output picture_file('methods')\n"
      "set title {} textcolor rgb ink font ',15'\n"
      "set logscale y\nset format y '1e%T'\nset format x '%g'\nunset mytics\n"
      "set xlabel 'time  [s]'\nset ylabel 'largest |E − E₀| of each stretch / largest kinetic "
      "energy  [1]'\n"
      "set key outside right top Left reverse title 'step, largest of all'\n"
      "set xrange [0:{:.6g}]\n"
      "plot {}\nunset output\n",
      gnuplotString(title + ": level is bounded"), duration, plots);
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
      for (const char* what : {"stroke", "fill", "color"})
        rules += fmt::format("[{0}=\"{1}\"] {{ {0}: #{2} }}\n", what, as, dark);
  }
  return rules;
}

/// An SVG on nothing has the colours of dark pages, too, for viewers that prefer them.
void addDarkColours(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string picture(std::istreambuf_iterator<char>(in), {});
  const std::size_t begin = picture.find("<svg"), end = picture.find('>', begin);
  if (begin == std::string::npos || end == std::string::npos) return;
  picture.insert(end + 1,
                 "\n<style>@media (prefers-color-scheme: dark) {\n" + darkRules() + "}</style>");
  std::ofstream(file, std::ios::binary | std::ios::trunc) << picture;
}

}  // namespace

std::optional<std::string> runGnuplot(const fs::path& folder, const std::string& script,
                                      const std::vector<std::string>& pictures,
                                      const PictureLook& look) {
  // -d: without the user's own start-up file, so that everybody's picture looks the same
  ChildOptions here;
  here.folder = folder;
  const Ending ending =
      Child({"gnuplot", "-d", "-e",
             fmt::format("picture = '{}'; paper = '{}'", look.kind, look.paper), script},
            here)
          .wait();
  std::string problem = oneLine(ending.problem);
  if (ending.not_found) problem = "gnuplot was not found (Debian: apt install gnuplot-nox)";
  for (const std::string& picture : pictures)
    if (problem.empty() && !isWhole(folder / picture))
      problem = "gnuplot did not finish " + picture;
  if (problem.empty()) {
    if (look.kind == "svg" && look.paper != "white")
      for (const std::string& picture : pictures) addDarkColours(folder / picture);
    return std::nullopt;
  }
  for (const std::string& picture : pictures) {
    std::error_code ignored;
    fs::remove(folder / picture, ignored);
  }
  return problem;
}

}  // namespace dynwitness::crosscheck
