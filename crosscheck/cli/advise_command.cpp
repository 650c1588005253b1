// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness advise: the cheapest model, integrator, step and arithmetic for an error.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/held_joints.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/uncertain_parameters.hpp"
#include "crosscheck/reduction/advice.hpp"
#include "crosscheck/reduction/fixed_point.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/envelope.hpp"
#include "scene/held_joints.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string json, folder, code;
  bool is_fixed_point = false;
  AdviceOptions options;
  PictureLook look;
};

/// Error against cost: a curve a model and arithmetic, the limit, and what is advised.
std::string adviceScript(const scene::Scene& scene, const Advice& advice, const std::string& stem) {
  const auto named = [&](const AdvisedCurve& curve) {
    const AdvisedCandidate& c = advice.candidates[curve.candidate];
    return fmt::format("{} model, {}, qdd in {}", advice.models[c.model].name(), c.method,
                       name(c.scalar));
  };
  std::string body = fmt::format(
      "set logscale xy\nset format x '1e%T'\nset format y '1e%T'\nunset mxtics\nunset mytics\n"
      "set xlabel 'operations of qdd a simulated second'\n"
      "set ylabel 'error of the end of {} s  [rad, m, rad/s, m/s]'\n"
      "set key top right\nset offsets graph 0.02, graph 0.02, graph 0.1, graph 0.02\n"
      "plot {} with lines linetype 20 title 'asked for: {:.3g}', \\\n",
      advice.duration, advice.error, advice.error);
  int k = 0;
  for (const AdvisedCurve& curve : advice.curves) {
    const AdvisedCandidate& c = advice.candidates[curve.candidate];
    ++k;
    body += fmt::format(
        "     '{0}.csv' using 2:(strcol(1) eq '{1}' ? $3 : 1/0) skip 2 with linespoints linetype {2} "
        "title '{3}', \\\n",
        stem, curveName(advice, c), k, named(curve));
  }
  return chartScript(
      scene, "what an error costs", stem,
      body +
          fmt::format("     '{}.csv' using 2:(strcol(1) eq 'advised' ? $3 : 1/0) skip 2 with "
                      "points pointtype 6 pointsize 3 linewidth 3 linecolor rgb ink title '{}'\n",
                      stem, advice.chosen ? "advised" : "nothing keeps it"));
}

/// The scene as the user has to write it again.
std::string wordsOf(const GivenScene& given) {
  return given.name.find_first_of(" '\"\\$") == std::string::npos ? given.name
                                                                  : "'" + given.name + "'";
}

int runFixedPoint(const Arguments& arguments) {
  scene::Scene scene = admitted(arguments.scene, Command::kReduce);
  requireMotion(scene);
  std::vector<scene::JointRanges> ranges = envelopeOf(arguments.scene, scene);
  tellNominalParameters(arguments.scene, scene);
  tellHeldJoints(scene::fixHeldJoints(&scene, &ranges), scene);
  FixedPoint fixed;
  {
    Progress progress("word lengths for " + scene.name);
    fixed = fixedPoint(scene, ranges, arguments.options.error,
                       [&](const std::string& what) { progress.note(what); });
  }
  fmt::print("{}", fixedPointText(scene, fixed));
  if (!arguments.code.empty()) writeWholeFile(arguments.code, fixed.code);
  if (!arguments.json.empty())
    writeWholeFile(arguments.json, fixedPointJson(scene, fixed, DYNWITNESS_VERSION));
  return fixed.isKept() ? 0 : 1;
}

int run(const Arguments& arguments) {
  requireWritableFile(arguments.json);
  requireWritableFile(arguments.code);
  if (!arguments.folder.empty()) requireWritableFolder(arguments.folder);
  if (arguments.options.error <= 0)
    throw scene::InputError({}, arguments.is_fixed_point
                                    ? "--error: not given, allowed: that of joint forces [N m, N]"
                                    : "--error: not given, allowed: the error of the end [rad, m, "
                                      "1/s]");
  if (arguments.is_fixed_point) return runFixedPoint(arguments);
  const scene::Scene scene = admitted(arguments.scene, Command::kAdvise);
  requireMotion(scene);
  const std::vector<scene::JointRanges> ranges = scene::hasEnvelope(scene)
                                                     ? envelopeOf(arguments.scene, scene)
                                                     : std::vector<scene::JointRanges>();
  tellNominalParameters(arguments.scene, scene);
  AdviceOptions options = arguments.options;
  options.draws = !arguments.folder.empty();
  Advice advice;
  {
    Progress progress("advice for " + scene.name);
    advice =
        adviceFor(scene, ranges, options, [&](const std::string& what) { progress.note(what); });
  }
  const std::string words = wordsOf(arguments.scene);
  fmt::print("{}", adviceText(scene, advice, words));
  if (advice.chosen && !arguments.scene.isAsWritten())
    fmt::print("  (each of {} with the same --set, --gravity, --base and --root)\n", words);
  if (!arguments.json.empty())
    writeWholeFile(arguments.json, adviceJson(scene, advice, words, DYNWITNESS_VERSION));
  if (!arguments.folder.empty()) {
    const std::string stem = safeName(scene.name) + "_advice";
    writeCharts({{stem, adviceCsv(advice)}}, {{stem, adviceScript(scene, advice, stem)}},
                arguments.folder, arguments.look);
  }
  return advice.chosen ? 0 : 1;
}

}  // namespace

Run addAdvise(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene: a tree; smaller models of it with [envelope]");
  command
      ->add_option("--error", arguments->options.error,
                   "Error: of the end, all coordinates and rates [rad, m, rad/s, m/s]; with "
                   "--fixed-point of each joint force [N m, N]")
      ->check(positive());
  CLI::Option* fixed_point = command->add_flag(
      "--fixed-point", arguments->is_fixed_point,
      "Bits for each signal of inverse dynamics in whole numbers, instead of a motion: proven over "
      "[envelope], compiled and run beside double");
  command
      ->add_option("--c", arguments->code,
                   "File: with --fixed-point, its C99 for a microcontroller")
      ->needs(fixed_point);
  CLI::Option* duration = command
                              ->add_option("--duration", arguments->options.duration,
                                           "Duration [s]: of the scene's motion")
                              ->check(positive())
                              ->capture_default_str();
  CLI::Option* method = command
                            ->add_option("--method", arguments->options.methods,
                                         "Integrators: [all that are explicit]")
                            ->delimiter(',');
  CLI::Option* budget =
      command
          ->add_option("--time-budget", arguments->options.time_budget,
                       "At most so many seconds of CPU a simulated second, measured here")
          ->check(positive());
  CLI::Option* chart =
      command->add_option("--chart", arguments->folder,
                          "Folder: error against cost, with what is advised, as CSV and a picture");
  CLI::Option* motions =
      command
          ->add_option(
              "--motions", arguments->options.motions,
              "Motions side by side: of several, the lanes of vectors are an arithmetic, a "
              "motion in each; costs are those of one")
          ->capture_default_str()
          ->check(whole(1, 1000000000));
  for (CLI::Option* of_motion : {duration, method, budget, chart, motions})
    fixed_point->excludes(of_motion);
  addPictures(*command, arguments->look);
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness advise double_pendulum --error 1e-3 --duration 5\n"
      "  dynwitness advise puma_560 --error 1e-2 --duration 1 --chart advice\n"
      "  dynwitness advise puma_560 --fixed-point --error 1e-3 --c puma_fixed.c\n"
      "  dynwitness advise puma_560 --error 1e-2 --duration 1 --motions 100\n"
      "Model (the scene, or a smaller one that `reduce` certifies in [envelope]), integrator,\n"
      "step and arithmetic (qdd as C code in float or double; of several motions also the\n"
      "kernel in lanes) together: the cheapest whose error stays below, and the commands that\n"
      "do it. Cost: counted operations of qdd. Errors are those of this motion, measured part\n"
      "by part; the share that joint forces miss by a smaller model is proven in [envelope].\n"
      "Exit status 1: nothing keeps the error.\n"
      "--fixed-point: cosines and sines are inputs (a table's, or CORDIC's), and whole numbers\n"
      "as all others; what is proven is of joint forces, not of a motion.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
