// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/drift_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/progress.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/inputs/states_file.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"
#include "crosscheck/motion/step_advice.hpp"
#include "crosscheck/motion/tree_motion.hpp"
#include "crosscheck/verdicts/own_motion.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

namespace {

std::string stepText(double step) {
  return std::isinf(step) ? "any" : step > 0 ? roundedDown(step, 3) : "none";
}

/// Of advice: what a method bears and needs.
std::string adviceLine(const std::string& method, const StepAdvice& stable,
                       const AccurateStep& accurate) {
  const StableStep& predicted = stable.predicted;
  const bool has_lambda = !std::isinf(predicted.step) && predicted.by_spectrum;
  return fmt::format(
      "{:<25} {:>12} {:>22} {:>10} {:>12} {:<11} {:>12} {:>10}\n", method, stepText(predicted.step),
      std::isinf(predicted.step) ? ""
      : predicted.is_unsolved    ? "no solution"
      : has_lambda ? fmt::format("{:.3g}{:+.3g}i", predicted.lambda.real(), predicted.lambda.imag())
                   : "steps gain energy",
      has_lambda ? fmt::format("{:.3g}", predicted.step * std::abs(predicted.lambda)) : "",
      stepText(stable.tried.step),
      std::isinf(stable.tried.step) ? ""
      : stable.tried.is_unsolved    ? "no solution"
                                    : "gains",
      accurate.step > 0 ? roundedDown(accurate.step, 3) + (accurate.is_predicted ? " by order" : "")
                        : "not seen",
      accurate.step > 0 ? fmt::format("{:.3g}", accurate.calls) : "");
}

}  // namespace

int adviseSteps(const scene::Scene& scene, std::vector<std::string> methods, double duration,
                double accuracy) {
  requireTreated(scene, Command::kDrift);
  const bool has_momenta = TreeMotion<double>(scene.mechanism).hasMomenta();
  if (methods.empty())
    for (const Integrator& method : integrators())
      if (has_momenta || !method.needs_momenta) methods.emplace_back(method.name);
  for (const std::string& method : methods) integratorNamed(method);
  std::string table = fmt::format("{:<25} {:>12} {:>22} {:>10} {:>12} {:<11} {:>12} {:>10}\n",
                                  "method", "predicted [s]", "lambda there [1/s]", "h|lambda|",
                                  "measured [s]", "beyond it", "accurate [s]", "calls");
  std::string cheapest, troubles;
  double fewest = 0, step = 0, trials = 0, known_to = 0;
  int runs = 0;
  {
    Progress progress(static_cast<int>(methods.size()) + 1);
    progress.stage("spectrum along the motion");
    const SpectrumAlong spectrum = spectrumAlong(scene, duration);
    const KnownEnd end = knownEnd(scene, duration, accuracy);
    known_to = end.error;
    for (const std::string& method : methods) {
      progress.stage(method);
      const StepAdvice stable = adviseStep(scene, spectrum, method);
      AccurateStep accurate;
      if (stable.tried.step > 0)
        accurate = accurateStep(scene, method, duration, accuracy,
                                std::min(stable.tried.step, duration), end);
      else
        accurate.why = "no step was found at which its energy does not double";
      table += adviceLine(method, stable, accurate);
      runs += stable.tried.runs;
      trials += static_cast<double>(stable.tried.calls) + static_cast<double>(accurate.tried_calls);
      if (!accurate.why.empty()) troubles += fmt::format("# {}: {}\n", method, accurate.why);
      if (accurate.step > 0 && (cheapest.empty() || accurate.calls < fewest)) {
        cheapest = method;
        fewest = accurate.calls;
        step = accurate.step;
      }
    }
  }
  fmt::print(
      "# {}: {} s from the start\n"
      "# largest step at which energy does not double: predicted by the spectrum and single steps "
      "along the motion, measured in {} runs around that; beyond it: a run gains that energy, or "
      "an implicit step has no solution\n"
      "# step for an error of {:.3g} at the end [rad, m, rad/s, m/s], measured against "
      "runge_kutta_fehlberg78 (known to {:.1g}); calls of the equations with it. All trials took "
      "{:.3g} calls\n{}{}",
      scene.name, duration, runs, accuracy, known_to, trials, table, troubles);
  if (cheapest.empty())
    fmt::print("cheapest     none: no method keeps that error, allowed: a shorter --duration\n");
  else
    fmt::print("cheapest     {} with h = {} s: {:.3g} calls of the equations\n", cheapest,
               roundedDown(step, 3), fewest);
  return 0;
}

namespace {

constexpr int kMoments = 200;  // of a motion that an engine makes

OwnMotion recorded(const scene::Scene& scene, const std::string& file,
                   const std::string& convention) {
  std::optional<CoordinateConvention> asked;
  if (!convention.empty()) asked = conventionNamed(convention);
  // what simulate --csv writes is one
  StatesReader reader(
      file, scene.mechanism,
      {{"t", "time_s", "kinetic_J", "potential_J", "phi", "phi_rate", "energy_error_J"},
       true,
       true},
      asked);
  const auto& others = reader.otherNames();
  const auto time = std::find_if(others.begin(), others.end(), [](const std::string& column) {
    return column == "t" || column == "time_s";
  });
  if (time == others.end() || !reader.gives("qd") || !reader.gives("qdd"))
    throw scene::InputError({file, 1},
                            "columns t (or time_s), q1.., qd1.. and qdd1.. are needed, some are "
                            "not there");
  OwnMotion motion;
  motion.by = file;
  scene::State<double> state;
  while (reader.next(&state)) {
    if (reader.gives("tau") &&
        std::any_of(state.tau.begin(), state.tau.end(), [](double x) { return x != 0; }))
      throw scene::InputError(
          {file, 0}, fmt::format("row {}: joint forces (tau), which change the energy, allowed: "
                                 "zeros; `evaluate --quantity residual,power` takes any",
                                 motion.moments.size() + 1));
    OwnMotion::Moment moment{
        reader.others()[static_cast<std::size_t>(time - others.begin())], {}, state.qd, state.qdd};
    for (const auto& x : state.x) moment.q.push_back(x.q);
    motion.moments.push_back(std::move(moment));
  }
  if (motion.moments.size() < 2)
    throw scene::InputError({file, 0},
                            fmt::format("{} rows, allowed: two or more", motion.moments.size()));
  return motion;
}

/// Energies along these motions, relative to the largest kinetic energy of the finest.
Drift energyAlong(const std::vector<OwnMotionVerdict>& motions, const std::vector<double>& steps) {
  Drift out;
  out.method = "given motions";
  out.duration = std::numeric_limits<double>::infinity();
  for (const OwnMotionVerdict& motion : motions)
    out.duration = std::min(out.duration, motion.time.back() - motion.time.front());
  double finest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const OwnMotionVerdict& motion = motions[k];
    const double mean =
        (motion.time.back() - motion.time.front()) / static_cast<double>(motion.time.size() - 1);
    Drift::Path path;
    path.step = steps.empty() ? mean : steps[k];
    for (std::size_t i = 0; i < motion.time.size(); ++i) {
      const double time = motion.time[i] - motion.time.front();
      if (time > out.duration) break;
      path.time.push_back(time);
      path.error.push_back(motion.energy_change[i]);
      path.end_time = time;
      keepWorse(&path.worst, motion.energy_change[i]);
    }
    if (path.step < finest) finest = path.step, out.scale = motion.most_kinetic;
    out.paths.push_back(std::move(path));
  }
  for (Drift::Path& path : out.paths) {
    if (out.scale == 0) continue;  // nothing moved, nothing was lost
    path.worst /= out.scale;
    for (double& error : path.error) error /= out.scale;
  }
  std::stable_sort(out.paths.begin(), out.paths.end(),
                   [](const Drift::Path& a, const Drift::Path& b) { return a.step > b.step; });
  const bool has_steps = std::adjacent_find(out.paths.begin(), out.paths.end(),
                                            [](const Drift::Path& a, const Drift::Path& b) {
                                              return a.step == b.step;
                                            }) == out.paths.end();
  out.observed_order = has_steps ? observedOrder(out) : 0;
  return out;
}

/// @throws scene::InputError  as many steps as neither engines nor files can have
void requireSteps(const std::vector<double>& steps, std::size_t engines, std::size_t files) {
  if (engines > 0 && steps.size() > 1)
    throw scene::InputError({}, fmt::format("{} steps, allowed: one (--step)", steps.size()));
  if (engines == 0 && !steps.empty() && steps.size() != files)
    throw scene::InputError(
        {}, fmt::format("--step: {} steps of {} motions, allowed: the step that each was made "
                        "with, or none, which is what is between its rows",
                        steps.size(), files));
}

}  // namespace

int judgeMotions(const scene::Scene& scene, const std::vector<std::string>& engines,
                 const std::vector<std::string>& files, const DriftOptions& options,
                 const std::string& convention, Drift* energy) {
  requireSteps(options.steps, engines.size(), files.size());
  constexpr double kStep = 0.001;  // [s]: what these engines' examples take
  const double step = options.steps.empty() ? kStep : options.steps.front();
  constexpr double kMostSteps = 1e8;
  if (!engines.empty() && (!(step <= options.duration) || !(options.duration / step <= kMostSteps)))
    throw scene::InputError({}, fmt::format("step is {} s, allowed: at most the duration of {} s, "
                                            "and at least a hundred millionth of it",
                                            step, options.duration));
  std::vector<OwnMotionVerdict> verdicts;
  std::string troubles;
  for (const std::string& file : files)
    verdicts.push_back(judgeOwnMotion(scene, recorded(scene, file, convention)));
  if (!files.empty())
    *energy = energyAlong(verdicts, engines.empty() ? options.steps : std::vector<double>());
  for (const std::string& engine : engines) {
    const WitnessKind kind = selectWitnesses({engine}).front();
    const MadeWitness made = kind.make(PreparedScene(scene));
    if (made.isRefused()) {
      troubles += fmt::format("# {}: not asked: {}\n", engine, made.refusal());
      continue;
    }
    auto* steps = dynamic_cast<OwnSteps*>((*made).get());
    if (steps == nullptr)
      throw scene::InputError({}, fmt::format("'{}' has no integrator of its own, allowed: mujoco, "
                                              "mujoco_principal, simbody, dart",
                                              engine));
    const scene::State<double> start = ConstrainedQuantities(scene).start();
    const long count = std::lround(options.duration / step);
    try {
      verdicts.push_back(judgeOwnMotion(
          scene, steps->ownMotion(start, step, count, std::max(1L, count / kMoments)),
          (*made).get()));
    } catch (const scene::InputError&) {
      throw;
    } catch (const std::runtime_error& error) {
      troubles += fmt::format("# {}: not asked: {}\n", engine, error.what());
    }
  }
  if (verdicts.empty()) {
    fmt::print("{}# {}: nothing was judged: none of these moves it\n", troubles, scene.name);
    return 1;
  }
  fmt::print("{}{}", ownMotionTable(scene, verdicts), troubles);
  return std::any_of(verdicts.begin(), verdicts.end(),
                     [](const OwnMotionVerdict& v) { return v.isModelWrong(); })
             ? 1
             : 0;
}

}  // namespace dynwitness::cli
