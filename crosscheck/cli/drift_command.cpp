// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness drift: energy along motions, by steps of ours, of a user and of engines.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/drift_tables.hpp"
#include "crosscheck/cli/given_states.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/drift.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/momentum_kept.hpp"
#include "crosscheck/motion/step_advice.hpp"
#include "crosscheck/report/assets.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/verdicts/check_drift.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

namespace {

struct DriftArguments {
  GivenScene scene;
  StartAsked start;
  std::string plot, csv;
  std::vector<std::string> motions, methods,
      engines;          ///< methods empty: runge_kutta4, or all for advice
  double accuracy = 0;  ///< of --advise; 0: not asked
  DriftOptions options;
  PictureLook look;
};

/// The report's drift chart alone, as one file.
void plotDrift(const scene::Scene& scene, const Drift& drift, const std::filesystem::path& file,
               const PictureLook& look) {
  SceneResult result;
  result.name = scene.name;
  result.title = scene.title;
  result.drift = drift;
  const std::string script = driftScript(result);
  if (script.empty()) throw std::runtime_error("no energy error above zero: nothing to draw");
  const UnfinishedFolder work(file.string() + ".work");  // vanishes again
  work.write("style.gp", kStyleGnuplot);
  work.write("chart/drift.csv", driftCsv(result));
  work.write("chart/drift_worst.csv", driftWorstCsv(result));
  work.write("chart/drift.gp", script);
  drawTo(file, work.path() / "chart", "drift", look);
}

/// Several methods in one picture: against their steps, or, with one each, against time.
void plotDrifts(const scene::Scene& scene, const std::vector<Drift>& drifts,
                const std::filesystem::path& file, const PictureLook& look) {
  const std::string title = scene.title.empty() ? scene.name : scene.title;
  const bool is_along = haveOneStepEach(drifts);
  const std::string script =
      is_along ? driftsAlongScript(title, drifts) : driftsScript(title, drifts);
  if (script.empty()) throw std::runtime_error("no energy error above zero: nothing to draw");
  const UnfinishedFolder work(file.string() + ".work");  // vanishes again
  work.write("style.gp", kStyleGnuplot);
  work.write("methods.csv", is_along ? driftsAlongCsv(drifts) : driftsCsv(drifts));
  work.write("methods.gp", script);
  drawTo(file, work.path(), "methods", look);
}

/// What is to be said about a drift beside its numbers. @return false: its qdd is wrong
bool remark(const scene::Scene& scene, const DriftOptions& options, const Drift& drift,
            std::string* text) {
  for (const Drift::Path& path : drift.paths)
    if (!std::isfinite(path.worst))
      *text += fmt::format(
          "# {}: not answerable by this step: at {} s the motion leaves the numbers (NaN or "
          "infinite energy)\n",
          drift.method, path.step);
  // steps that were asked for: why they do not follow, and which would
  if (!options.steps.empty())
    for (const Drift::Path& path : drift.paths)
      if (isLost(path))
        *text += fmt::format("# {}\n", adviceAfterFailure(scene, drift.method, options.duration,
                                                          path.step, lossTime(path)));
  const bool is_judged = drift.paths.size() > 1 || !std::isfinite(drift.paths.back().worst);
  if (isResolved(drift) || drift.scale == 0 || !is_judged) {
    *text += fmt::format("# {}: observed order {}, its own {}\n", drift.method,
                         drift.observed_order > 0 ? fmt::format("{:.2f}", drift.observed_order)
                                                  : "not to be seen at these steps",
                         drift.method_order);
    return true;
  }
  const CheckResult check = checkDrift(scene, drift, options);
  if (check.verdict == Verdict::kAgree)
    *text += fmt::format("# {}: not answerable by these steps, qdd is not to blame: {}\n",
                         drift.method, check.statement);
  else
    *text += fmt::format("# {}: {}{}\n", drift.method,
                         check.verdict == Verdict::kDisagree ? "DISAGREE: " : "", check.reason);
  return check.verdict != Verdict::kDisagree;
}

/// Of a mechanism that nothing acts on from outside: how far the finest path's end is from the
/// momentum that it started with.
std::string momentumText(const scene::Scene& scene, const Drift& drift) {
  const auto path = std::find_if(drift.paths.rbegin(), drift.paths.rend(),
                                 [](const Drift::Path& p) { return !p.end.empty(); });
  if (path == drift.paths.rend()) return "";
  const std::optional<double> moved = momentumMoved(scene, path->end);
  if (!moved) return "";
  return fmt::format(
      "# momentum: {} with h = {:.3g} s moves that of the whole, on which nothing acts from outside, by "
      "{:.2g} of its largest part [N s, N m s]; rounding may by {:.2g}\n",
      drift.method, path->step, *moved,
      roundingOfMomentum(scene.mechanism, path->end_time / path->step));
}

/// What was said about the worst errors, a line a path.
std::string worstTable(const std::vector<Drift>& drifts) {
  std::string csv = "method,step_s,worst_error,scale_J\n";
  for (const Drift& drift : drifts)
    for (const Drift::Path& path : drift.paths)
      csv += fmt::format("{},{},{},{}\n", drift.method, path.step, path.worst, drift.scale);
  return csv;
}

/// Motions of engines and of files on the stand, and energy along those of files.
int judgeGiven(const scene::Scene& scene, const DriftArguments& arguments,
               const PictureLook& look) {
  if (arguments.motions.empty() && !(arguments.csv.empty() && arguments.plot.empty()))
    throw scene::InputError({},
                            "--plot or --csv with --engine-steps, allowed: with --method or "
                            "--motion, whose energy they show");
  Drift energy;
  const int status = judgeMotions(scene, arguments.engines, arguments.motions, arguments.options,
                                  arguments.start.convention, &energy);
  if (energy.paths.empty()) return status;
  const std::string csv =
      fmt::format("# {}: largest |E - E0| along {} s of each, over the largest kinetic energy\n{}",
                  scene.name, energy.duration, worstTable({energy}));
  fmt::print("{}# observed order {}\n", csv,
             energy.observed_order > 0  ? fmt::format("{:.2f}", energy.observed_order)
             : energy.paths.size() == 1 ? "not to be seen in one motion, allowed: several with "
                                          "commas, of different steps"
                                        : "not to be seen: their steps (--step) do not differ, or "
                                          "nothing is lost but rounding");
  if (!arguments.csv.empty()) writeWholeFile(arguments.csv, csv);
  if (!arguments.plot.empty()) plotDrift(scene, energy, arguments.plot, look);
  return status;
}

int runDrift(const DriftArguments& arguments) {
  const PictureLook look =
      arguments.plot.empty() ? PictureLook() : lookOfFile(arguments.plot, arguments.look);
  for (const std::string& file : {arguments.csv, arguments.plot}) requireWritableFile(file);
  requireFileOfConvention(arguments.start,
                          arguments.motions.empty() ? "" : arguments.motions.front());
  const scene::Scene scene = startedAt(admitted(arguments.scene, Command::kDrift), arguments.start);
  requireMotion(scene);
  if (!arguments.motions.empty() || !arguments.engines.empty())
    return judgeGiven(scene, arguments, look);
  if (arguments.accuracy > 0)
    return adviseSteps(scene, arguments.methods, arguments.options.duration, arguments.accuracy);
  std::vector<std::string> methods = arguments.methods;
  if (methods.empty()) methods = {"runge_kutta4"};
  Progress progress(static_cast<int>(methods.size()));
  std::vector<Drift> drifts;
  std::string remarks, ends;
  bool agree = true;
  for (const std::string& method : methods) {
    progress.stage(method);
    DriftOptions options = arguments.options;
    options.method = method;
    drifts.push_back(measureDrift(scene, options));
    if (drifts.back().paths.empty()) throw scene::InputError({scene.file.string()}, kNoMotion);
    agree = remark(scene, options, drifts.back(), &remarks) && agree;
    eraseLostPaths(drifts.back());
    remarks += momentumText(scene, drifts.back());
    std::string said;  // against the first that arrives
    for (std::size_t k = 0; k + 1 < drifts.size() && said.empty(); ++k)
      said = comparedEnds(scene, drifts[k], drifts.back());
    if (!said.empty()) ends += fmt::format("# ends: {}\n", said);
  }
  const std::string csv = fmt::format(
      "# {}: largest |E - E0| along {} s from the start state, over the largest kinetic energy\n{}",
      scene.name, arguments.options.duration, worstTable(drifts));
  if (std::all_of(drifts.begin(), drifts.end(),
                  [](const Drift& drift) { return drift.paths.empty(); }))
    throw scene::InputError(
        {scene.file.string()},
        "no step follows the motion, allowed: shorter ones (--step), or 'dynwitness simulate', "
        "whose steps adapt\n" +
            remarks);
  fmt::print("{}{}{}", csv, remarks, ends);
  if (!arguments.csv.empty()) writeWholeFile(arguments.csv, csv);
  if (!arguments.plot.empty() && drifts.size() == 1)
    plotDrift(scene, drifts.front(), arguments.plot, look);
  else if (!arguments.plot.empty())
    plotDrifts(scene, drifts, arguments.plot, look);
  return agree ? 0 : 1;
}

}  // namespace

Run addDrift(CLI::App* command) {
  auto arguments = std::make_shared<DriftArguments>();
  addScene(*command, arguments->scene, "Scene");
  addStart(*command, arguments->start);
  CLI::Option* method = command->add_option("--method", arguments->methods,
                                            "Integrators: [runge_kutta4] " + integratorNames());
  method->delimiter(',');
  CLI::Option* advise = command->add_option(
      "--advise", arguments->accuracy,
      "Which step, and not its energy: the largest stable one of each method (without --method, of "
      "all), predicted by spectrum and single steps along the motion and measured by runs around "
      "that, and the one for this error of the end [rad, m, 1/s], measured");
  advise->check(positive());
  CLI::Option* engines = command->add_option(
      "--engine-steps", arguments->engines,
      "No runs of ours: mujoco, simbody, dart move the scene by their own integrators, and each "
      "motion is judged: wrong model, or wrong step?");
  engines->delimiter(',')->excludes(advise);
  CLI::Option* motion = command->add_option(
      "--motion", arguments->motions,
      "The same for recorded ones, and their energy: CSV with t, q1.., qd1.., qdd1..; - reads "
      "standard input; several with commas, of one motion by different steps, show the order");
  motion->excludes(advise)->delimiter(',');
  for (const char* start : {"--q", "--qd", "--states"})
    command->get_option(start)->excludes(motion);
  for (CLI::Option* theirs : {engines, motion}) theirs->excludes(method);
  command->footer(
      "Examples:\n"
      "  dynwitness drift furuta_pendulum --method runge_kutta4,gauss_6 --plot drift.svg\n"
      "  dynwitness drift simple_pendulum --method stormer_verlet,gauss_4 --step 0.07 \\\n"
      "    --plot swings.svg\n"
      "  dynwitness drift double_pendulum --motion coarse.csv,fine.csv --plot energy.svg\n"
      "  dynwitness drift double_pendulum --advise 0.001\n\n" +
      integratorTable() +
      "h|i w|, h|-a|: largest step times eigenvalue on the imaginary and on the negative "
      "real axis that does not grow");
  command
      ->add_option(
          "--step", arguments->options.steps,
          "Step size [s]: several with commas; without any 0.01, halved until the order shows; of "
          "--motion those that the files were made with, without any what is between their rows")
      ->check(positive())
      ->delimiter(',')
      ->excludes(advise);
  command->add_option("--duration", arguments->options.duration, "Duration [s]: simulated time")
      ->check(positive())
      ->capture_default_str();
  CLI::Option* plot = command->add_option(
      "--plot", arguments->plot,
      "Chart, a file that ends in .svg (as one without ending is), .png or .pdf: "
      "energy errors along the "
      "paths of one method, or the worst ones of several against the step; of several with one "
      "step, against time");
  addBackground(*command, arguments->look);
  command->get_option("--background")->needs(plot);
  CLI::Option* csv =
      command->add_option("--csv", arguments->csv, "Table as a CSV file: the printed one");
  for (CLI::Option* ours : {plot, csv}) ours->excludes(advise);
  return [arguments] { return runDrift(*arguments); };
}

}  // namespace dynwitness::cli
