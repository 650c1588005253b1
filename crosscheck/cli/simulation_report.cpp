// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/simulation_report.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/motion/formulations.hpp"
#include "crosscheck/motion/integrators.hpp"
#include "crosscheck/motion/state_gap.hpp"

namespace dynwitness::cli {

using namespace crosscheck;

nlohmann::json jsonOf(const Simulation& r) {
  return {{"steps", r.steps},
          {"rejected", r.rejected},
          {"evaluations", r.evaluations},
          {"cpu_s", r.cpu_s},
          {"phi", r.worst_phi},
          {"phi_rate", r.worst_phi_rate},
          {"energy_error_J", r.worst_energy}};
}
nlohmann::json jsonOf(const MotionTable& table, const MotionVerdict& verdict) {
  return {{"title", table.title}, {"worst", verdict.worst}, {"ratio", verdict.ratio}};
}

nlohmann::json jsonOf(const Simulation::Task& task) {
  nlohmann::json out = {{"name", task.name}, {"yields", task.yields}};
  if (task.has_rate) out["rate_error"] = task.worst_rate;
  if (task.has_place) out["place_error_m"] = task.worst_place;
  return out;
}

nlohmann::json jsonHead(const scene::Scene& scene, const SimulateOptions& options) {
  return {{"dynwitness", DYNWITNESS_VERSION},
          {"scene", scene.name},
          {"duration_s", options.duration},
          {"step_error", options.step_error},
          {"step_s", options.step}};
}

std::string describe(const SimulateOptions& options) {
  const bool is_adaptive = !hasEqualSteps(options.method);
  return is_adaptive ? fmt::format("{}, error of a step {:.3g}", options.method, options.step_error)
                     : fmt::format("{}, steps of {} s", options.method, options.step);
}

namespace {

/// Acceleration constraints, or the controller's tasks, along the motion.
void printTasks(const Simulation& result, const Controller& controller) {
  for (std::size_t k = 0; k < result.tasks.size(); ++k) {
    const Simulation::Task& task = result.tasks[k];
    std::string drift = fmt::format("xd {:.2g}", task.worst_rate);
    if (task.has_place) drift += fmt::format(", x {:.2g} m", task.worst_place);
    if (!task.has_rate) drift = "no integral: its direction turns with the link";
    fmt::print("{}'{}': nu {:.6g} at the end; {} {}\n",
               k > 0                                                ? "             "
               : controller.tasks == Controller::Tasks::kConstraint ? "held         "
                                                                    : "tasks        ",
               task.name, result.points.back().nu[k],
               !task.has_rate ? ""
               : task.yields  ? "gave way by"
                              : "off its integral by",
               drift);
  }
}
void printConstraints(const SimulatedRun& run) {
  const Simulation& result = run.result;
  const SimulateOptions& options = run.options;
  if (result.constraints == 0) return;

  fmt::print("constraints  {} equations of rank {}{}, {} freedoms; kept by {}\n",
             result.constraints, result.rank_highest,
             result.rank_lowest == result.rank_highest
                 ? ""
                 : fmt::format(", {} in singular poses", result.rank_lowest),
             run.scene.mechanism.dof() - result.rank_highest,
             options.formulation != Formulation::kIndex1     ? name(options.formulation)
             : options.stabilisation == Stabilisation::kNone ? "nothing"
                                                             : name(options.stabilisation));
  const Simulation::Point& last = result.points.back();
  std::string lambda;
  for (std::size_t i = 0; i < last.lambda.size() && last.lambda.size() <= 12; ++i)
    lambda += fmt::format("{}{:.10g}{}", i == 0 ? "" : ", ", last.lambda[i],
                          last.determined[i] ? "" : " (not determined)");
  if (!lambda.empty()) fmt::print("multipliers  {} at t = {} s\n", lambda, last.time);
  fmt::print("drift        |phi| {:.2g}, |J qd| {:.2g}; at the start {:.2g}\n", result.worst_phi,
             result.worst_phi_rate, result.start_residual);
}

void printEnergy(const Simulation& result) {
  fmt::print("energy       |E - E0 - work| {:.2g} J, largest kinetic energy {:.4g} J{}\n",
             result.worst_energy, result.most_kinetic,
             result.points.back().work == 0
                 ? ""
                 : fmt::format(", work {:.6g} J", result.points.back().work));
}

/// How the second run differs from the first.
std::string halfOf(const SimulateOptions& options) {
  return hasEqualSteps(options.method)
             ? "steps of half the length"
             : fmt::format("{}, half the error a step and twice the outputs",
                           finer(options).method);
}

/// How far the run itself may be off. @return  whether it shares a digit with its rerun
bool reportAccuracy(const SimulatedRun& run, nlohmann::json* all) {
  const std::string half = halfOf(run.options);
  if (run.rerun == nullptr) {
    if (!run.no_rerun.empty())
      fmt::print("accuracy     not known, a run with {} fails: {}\n", half, run.no_rerun);
    return true;
  }
  const MotionGap off = gapBetween(*run.rerun, run.result);
  if (off.shared == 0) {
    fmt::print(
        "accuracy     not known: the event is before the first row of the table, allowed: more "
        "--outputs\n");
    return true;
  }
  double most = 0;
  for (const Simulation::Point& point : run.result.points)
    for (const double q : point.q) most = std::max(most, std::abs(q));
  const int shared = sharedDigits(off.q, most);
  fmt::print(
      "accuracy     a run with {} is up to {:.2g} (rad, m) and {:.2g} (rad/s, m/s) away: positions "
      "{}\n",
      half, off.q, off.qd, agreementText(shared));
  (*all)["rerun"] = {{"with", half}, {"q", off.q}, {"qd", off.qd}, {"shared_digits", shared}};
  return shared > 0;
}

/// @return  whether all of them happened, and in the rerun as well
bool reportEvents(const SimulatedRun& run, nlohmann::json* all) {
  const Simulation& result = run.result;
  const SimulateOptions& options = run.options;
  if (!options.until.of) return true;
  bool agree = true;
  std::string times;
  constexpr std::size_t kMost = 12;
  for (std::size_t k = 0; k < result.events.size() && k < kMost; ++k)
    times += fmt::format("{}{:.10g}", k == 0 ? " at t = " : ", ", result.events[k]);
  if (result.events.size() > kMost) times += ", ...";
  fmt::print("events       {} of {} of {}{}{}\n", result.events.size(), options.until.times,
             run.until, times, times.empty() ? "" : " s");
  if (const std::size_t count = result.events.size(); count > 1)
    fmt::print("period       {:.10g} s between the last two, {:.10g} s on average\n",
               result.events[count - 1] - result.events[count - 2],
               (result.events.back() - result.events.front()) / static_cast<double>(count - 1));
  (*all)["events"] = {
      {"of", run.until}, {"asked", options.until.times}, {"times_s", result.events}};
  if (static_cast<int>(result.events.size()) < options.until.times) agree = false;
  if (run.rerun != nullptr) {
    const double apart = eventGap(*run.rerun, result);
    agree = agree && std::isfinite(apart);
    fmt::print("             a run with {} {}\n", halfOf(options),
               std::isfinite(apart)
                   ? fmt::format("has them up to {:.2g} s earlier or later", apart)
                   : fmt::format("DISAGREES: it has {}", run.rerun->events.size()));
    (*all)["events"]["apart_s"] = std::isfinite(apart) ? nlohmann::json(apart) : nullptr;
  }
  return agree;
}

/// @return  whether published motions are met
bool reportPublished(const SimulatedRun& run, nlohmann::json* all) {
  bool agree = true;
  for (const MotionTable& table : run.tables) {
    const MotionVerdict verdict = compareMotion(run.scene, run.result, table);
    if (verdict.values == 0) {
      fmt::print("published    {}: none of its times within {} s\n", table.title,
                 run.options.duration);
      continue;
    }
    agree = agree && verdict.ratio <= 1;
    (*all)["published"].push_back(jsonOf(table, verdict));
    fmt::print("published    {}: {} values, {}, worst {:.2g}, {:.0f}% of the limit at t = {} s\n",
               table.title, verdict.values, verdict.ratio <= 1 ? "agree" : "DISAGREE",
               verdict.worst, 100 * verdict.ratio, verdict.worst_time);
  }
  return agree;
}

}  // namespace

bool reportRun(const SimulatedRun& run, nlohmann::json* all) {
  const Simulation& result = run.result;
  const SimulateOptions& options = run.options;
  for (const double error :
       {result.worst_phi, result.worst_phi_rate, result.worst_energy, result.most_kinetic})
    if (!std::isfinite(error))
      throw std::runtime_error("simulate: energy or constraints are not finite along the motion");
  *all = jsonHead(run.scene, options);
  (*all)["formulation"] = name(options.formulation);
  (*all)["stabilisation"] = name(options.stabilisation);
  (*all)["method"] = options.method;
  (*all)["constraints"] = {{"equations", result.constraints},
                           {"rank_lowest", result.rank_lowest},
                           {"rank_highest", result.rank_highest},
                           {"start_residual", result.start_residual}};
  (*all)["largest_kinetic_energy_J"] = result.most_kinetic;
  all->update(jsonOf(result));
  for (const Simulation::Task& task : result.tasks) (*all)["tasks"].push_back(jsonOf(task));
  (*all)["controller"] = name(options.controller.tasks);
  (*all)["work_J"] = result.points.back().work;

  fmt::print("{}: {} s with {}\n", run.scene.name, options.duration, describe(options));
  printConstraints(run);
  printTasks(result, options.controller);
  printEnergy(result);
  bool agree = reportAccuracy(run, all);
  agree = reportEvents(run, all) && agree;
  fmt::print("cost         {} steps and {} rejected, {} evaluations, {:.3g} s\n", result.steps,
             result.rejected, result.evaluations, result.cpu_s);
  return reportPublished(run, all) && agree;
}

}  // namespace dynwitness::cli
