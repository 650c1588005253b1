// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of a scene: energy drift, and speed against accuracy.
#include <algorithm>
#include <cmath>

#include "crosscheck/report/page_sections.hpp"
#include "crosscheck/report/page_words.hpp"

namespace dynwitness::crosscheck {

void putDrift(std::string* page, const SceneResult& scene, const SceneFiles& files) {
  if (!scene.drift) return;
  const Drift& drift = *scene.drift;
  put(page, "<h2>Energy drift</h2>\n");
  std::string sentence = fmt::format(
      "Largest |E − E₀| along a path of {} s, as a share of the largest kinetic energy "
      "({:.3g} J), integrated with {}.",
      drift.duration, drift.scale, drift.method);
  if (std::isfinite(drift.observed_order) && drift.observed_order > 0)
    sentence += fmt::format(" Observed order {:.2f}; the method promises {}.", drift.observed_order,
                            drift.method_order);
  if (!drift.paths.empty()) {
    const Drift::Path& finest = *std::min_element(
        drift.paths.begin(), drift.paths.end(),
        [](const Drift::Path& a, const Drift::Path& b) { return a.step < b.step; });
    sentence +=
        fmt::format(" At the finest step, {} s, it is {}.", finest.step, readable(finest.worst));
  }
  put(page, "<figure class=\"charts\">\n");
  if (!files.drift.empty()) {
    openScroll(page, "Charts of the energy drift");
    put(page,
        "<img src=\"{}\" width=\"1000\" height=\"400\" alt=\"Two charts. Left: energy error "
        "against "
        "time, one curve a step size. Right: worst error against step size. "
        "{}\">\n</div>\n",
        files.drift, esc(sentence));
  } else {
    put(page, "<p class=\"soft\">The plot was left out: {}. Its data are there.</p>\n",
        esc(files.no_plot_reason));
  }
  put(page,
      "<figcaption>{} Data: <a href=\"{}\">along the paths</a>, <a href=\"{}\">worst of each "
      "step</a>",
      esc(sentence), files.drift_csv, files.drift_worst_csv);
  if (!files.drift_script.empty())
    put(page, "; <a href=\"{}\">gnuplot script</a>", files.drift_script);
  put(page, ".</figcaption>\n</figure>\n");
}

void putChart(std::string* page, const SceneFiles& files) {
  if (files.chart_csv.empty()) return;
  put(page, "<h2>Speed against accuracy</h2>\n<figure class=\"charts\">\n");
  if (!files.chart.empty()) {
    openScroll(page, "Charts of speed against accuracy");
    put(page,
        "<img src=\"{}\" width=\"1000\" height=\"480\" alt=\"Two charts, time of one evaluation "
        "against worst relative error. Left: the sweep in five arithmetics. Right: every method in "
        "double. The numbers are in the data file.\">\n</div>\n",
        files.chart);
  } else {
    put(page, "<p class=\"soft\">The plot was left out: {}. Its data are there.</p>\n",
        esc(files.no_chart_reason));
  }
  put(page,
      "<figcaption>tau, inverse dynamics: each method's time and its worst error against the "
      "certified truth; lower left is better. A time starts at joint positions as numbers, so that "
      "sines and position kinematics are in it; engines are timed by their own calls where their "
      "name stands alone. Times are of this machine and of this run, and nothing here is judged by "
      "them. Data: <a href=\"{}\">all methods</a>; <a "
      "href=\"{}\">gnuplot "
      "script</a>.</figcaption>\n</figure>\n",
      files.chart_csv, files.chart_script);
}

}  // namespace dynwitness::crosscheck
