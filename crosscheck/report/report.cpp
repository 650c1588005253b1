// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/report.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <future>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/chart_drawing.hpp"
#include "crosscheck/report/digits_table.hpp"
#include "crosscheck/report/json.hpp"
#include "crosscheck/report/page.hpp"
#include "crosscheck/report/pairs.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/report/tree_svg.hpp"
#include "crosscheck/system/processes.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Writes data, script and, where gnuplot can, the pictures.
void writeDrift(const SceneResult& scene, const std::string& folder, const UnfinishedFolder& out,
                SceneFiles* files) {
  files->drift_csv = "drift.csv";
  files->drift_worst_csv = "drift_worst.csv";
  out.write(folder + "/drift.csv", driftCsv(scene));
  out.write(folder + "/drift_worst.csv", driftWorstCsv(scene));
  const std::string script = driftScript(scene);
  if (script.empty()) {
    files->no_plot_reason = "no error above zero was seen, and the axis is logarithmic";
    return;
  }
  files->drift_script = "drift.gp";
  out.write(folder + "/drift.gp", script);
  const auto problem = runGnuplot(out.path() / folder, "drift.gp", {"drift.svg"});
  if (problem) {
    files->no_plot_reason = *problem;
    return;
  }
  files->drift = "drift.svg";
}

void writeChart(const Chart& chart, const std::string& folder, const UnfinishedFolder& out,
                SceneFiles* files) {
  files->chart_csv = "speed.csv";
  out.write(folder + "/speed.csv", chartCsv({chart}));
  files->chart_script = "speed.gp";
  out.write(folder + "/speed.gp", chartScript(chart, "speed", "../style.gp"));
  const auto problem = runGnuplot(out.path() / folder, "speed.gp", {"speed.svg"});
  if (problem) {
    files->no_chart_reason = *problem;
    return;
  }
  files->chart = "speed.svg";
}

}  // namespace

BenchFiles writeBenchChart(const BenchResult& bench, const UnfinishedFolder& folder,
                           const std::string& name, const std::string& style) {
  const std::string in = name.empty() ? "" : name + "/";
  BenchFiles files;
  files.csv = in + "bench.csv";
  folder.write(files.csv, benchCsv(bench));
  const std::string script = benchScript(bench, style);
  if (script.empty()) {
    files.no_plot_reason = "no time was measured";
    return files;
  }
  files.script = in + "bench.gp";
  folder.write(files.script, script);
  const auto problem = runGnuplot(folder.path() / name, "bench.gp", {"bench.svg"});
  if (problem) {
    files.no_plot_reason = *problem;
    return files;
  }
  files.picture = in + "bench.svg";
  return files;
}

namespace {

/// All tasks, some at a time: they wait for gnuplot, which is a process of its own.
void inThreads(const std::vector<std::function<void()>>& tasks) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i; (i = next++) < tasks.size();) tasks[i]();
  };
  std::vector<std::future<void>> workers;
  try {
    for (std::size_t k = 1; k < std::min<std::size_t>(availableProcessors(), tasks.size()); ++k)
      workers.push_back(std::async(std::launch::async, work));
  } catch (const std::system_error&) {  // no room for another thread: those that are there do it
  }
  work();
  for (std::future<void>& worker : workers) worker.get();
}

/// The audit's page, where it lies in the report's folder, or how to have it there.
std::string chapterSection(const std::filesystem::path& folder) {
  std::string page =
      "<section aria-labelledby=\"chapter\">\n<h2 id=\"chapter\">The textbook chapter</h2>\n<p>H. "
      "Bruyninckx, <i>Dynamics of robots</i>, whose letters the sweeps use: which of its equations "
      "hold, and what is so where they do not, with numbers for the board.</p>\n<p>";
  page += std::filesystem::is_regular_file(folder / "audit" / "index.html")
              ? "<a href=\"audit/index.html\">The audit, equation by equation</a>, as "
                "<code>dynwitness audit -o FOLDER/audit</code> left it (FOLDER: this page's)."
              : "<code>dynwitness audit -o FOLDER/audit</code>, FOLDER being this page's, "
                "writes the page in two seconds, and the next report links to it.";
  return page + "</p>\n</section>\n";
}

}  // namespace

void writeReport(const CrosscheckResult& result, const Environment& environment,
                 const std::filesystem::path& folder, const std::vector<Chart>& charts,
                 const BenchResult* bench, const std::vector<std::string>& views,
                 const PairTable* pairs, const std::string& atlas,
                 const std::map<std::string, std::string>& models) {
  if (!charts.empty() && charts.size() != result.scenes.size())
    throw std::invalid_argument(fmt::format("writeReport: charts: expected none or {}, got {}",
                                            result.scenes.size(), charts.size()));
  if (!views.empty() && views.size() != result.scenes.size())
    throw std::invalid_argument(fmt::format("writeReport: views: expected none or {}, got {}",
                                            result.scenes.size(), views.size()));
  requireWritable(folder);
  UnfinishedFolder out(folder);
  out.write("scenes/style.gp", kStyleGnuplot);
  const std::vector<std::string> names = safeNames(result.scenes);
  std::vector<SceneFiles> files(result.scenes.size());
  std::vector<std::function<void()>> drawings;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const SceneResult& scene = result.scenes[i];
    const std::string scene_folder = "scenes/" + names[i];
    files[i].page = scene_folder + "/index.html";
    files[i].anchor = "scene-" + names[i];
    if (const std::string svg = treeSvg(scene, SvgUse::kFile); !svg.empty()) {
      files[i].tree = "tree.svg";
      out.write(scene_folder + "/tree.svg", svg);
    }
    if (const auto found = models.find(scene.name); found != models.end())
      files[i].models = found->second;
    if (!views.empty() && !views[i].empty()) {
      files[i].view = "view.html";
      out.write(scene_folder + "/view.html", views[i]);
    }
    if (scene.drift)
      drawings.push_back([&, i, scene_folder] { writeDrift(scene, scene_folder, out, &files[i]); });
    if (!charts.empty() && !charts[i].points.empty())
      drawings.push_back(
          [&, i, scene_folder] { writeChart(charts[i], scene_folder, out, &files[i]); });
  }
  BenchFiles bench_files;
  if (bench)
    drawings.push_back(
        [&] { bench_files = writeBenchChart(*bench, out, "bench", "../scenes/style.gp"); });
  inThreads(drawings);
  out.write("report.json",
            reportJson(result, environment, bench ? benchJson(*bench) : std::string(),
                       pairs ? pairsJson(*pairs) : std::string()));
  out.write("junit.xml", reportJUnit(result, environment));
  out.write("digits.md", digitsTable(result, environment));
  for (std::size_t i = 0; i < files.size(); ++i)
    out.write(files[i].page, scenePage(result, i, environment, files[i]));
  out.write("index.html",
            reportPage(result, environment, files,
                       atlas + (pairs ? pairsSection(*pairs) : std::string()) +
                           (bench ? benchSection(*bench, bench_files) : std::string()) +
                           chapterSection(folder)));
  out.moveIntoPlace("index.html");
}

}  // namespace dynwitness::crosscheck
