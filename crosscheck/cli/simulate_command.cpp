// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness simulate: the motion of a scene with its closures, springs and loads.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/crosscheck.hpp"
#include "crosscheck/motion_tables.hpp"
#include "crosscheck/report/files.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  std::string scene, csv, stabilisation = "projection";
  SimulateOptions options;
};

const std::pair<const char*, Stabilisation> kStabilisations[] = {
    {"none", Stabilisation::kNone},
    {"baumgarte", Stabilisation::kBaumgarte},
    {"projection", Stabilisation::kProjection}};

/// One row an output: time, q, qd, and how far constraints and energy are off.
std::string csvOf(const Simulation& simulation) {
  const Simulation::Point& first = simulation.points.front();
  std::string csv = "time_s";
  for (std::size_t i = 1; i <= first.q.size(); ++i) csv += fmt::format(",q{}", i);
  for (std::size_t i = 1; i <= first.qd.size(); ++i) csv += fmt::format(",qd{}", i);
  csv += ",phi,phi_rate,energy_error_J\n";
  for (const Simulation::Point& point : simulation.points) {
    csv += fmt::format("{:.17g}", point.time);
    for (const auto* values : {&point.q, &point.qd})
      for (const double v : *values) csv += fmt::format(",{:.17g}", v);
    csv += fmt::format(",{:.3g},{:.3g},{:.3g}\n", point.phi, point.phi_rate, point.energy_error);
  }
  return csv;
}

int run(Arguments arguments) {
  const scene::Scene scene = scene::findScene(arguments.scene);
  requireMotion(scene);
  for (const auto& [name, value] : kStabilisations)
    if (arguments.stabilisation == name) arguments.options.stabilisation = value;
  const std::vector<MotionTable> tables = motionTables(scene);
  for (const MotionTable& table : tables)
    for (const MotionTable::Row& row : table.rows) arguments.options.more_times.push_back(row.time);
  const Simulation result = simulate(scene, arguments.options);

  fmt::print("{}: {} s with {}, error of a step {}\n", scene.name, arguments.options.duration,
             arguments.options.method, arguments.options.step_error);
  if (result.constraints > 0) {
    fmt::print("constraints  {} equations of rank {}{}, {} freedoms; kept by {}\n",
               result.constraints, result.rank_highest,
               result.rank_lowest == result.rank_highest
                   ? ""
                   : fmt::format(", {} in singular poses", result.rank_lowest),
               scene.mechanism.dof() - result.rank_highest,
               arguments.options.stabilisation == Stabilisation::kNone ? "nothing"
                                                                       : arguments.stabilisation);
    fmt::print("drift        |phi| {:.2g}, |J qd| {:.2g}; at the start {:.2g}\n", result.worst_phi,
               result.worst_phi_rate, result.start_residual);
  }
  fmt::print("energy       |E - E0 - work| {:.2g} J, largest kinetic energy {:.4g} J\n",
             result.worst_energy, result.most_kinetic);
  fmt::print("cost         {} steps and {} rejected, {} evaluations, {:.3g} s\n", result.steps,
             result.rejected, result.evaluations, result.cpu_s);
  bool agree = true;
  for (const MotionTable& table : tables) {
    const MotionVerdict verdict = compareMotion(scene, result, table);
    if (verdict.values == 0) {
      fmt::print("published    {}: none of its times within {} s\n", table.title,
                 arguments.options.duration);
      continue;
    }
    agree = agree && verdict.ratio <= 1;
    fmt::print("published    {}: {} values, {}, worst {:.2g}, {:.0f}% of the limit at t = {} s\n",
               table.title, verdict.values, verdict.ratio <= 1 ? "agree" : "DISAGREE",
               verdict.worst, 100 * verdict.ratio, verdict.worst_time);
  }
  if (!arguments.csv.empty()) writeWholeFile(arguments.csv, csvOf(result));
  return agree ? 0 : 1;
}

}  // namespace

Run addSimulate(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "simulate", "Move a scene with its closures, springs and loads; drift, cost, published motions");
  command->add_option("scene", arguments->scene, "Scene")->required();
  command->add_option("--duration", arguments->options.duration, "Simulated time [s]")
      ->capture_default_str();
  std::string methods;
  for (const std::string& method : simulateMethods()) methods += (methods.empty() ? "" : ", ") + method;
  command->add_option("--method", arguments->options.method, "Integrator: " + methods)
      ->capture_default_str();
  command->add_option("--step-error", arguments->options.step_error, "Error of a step, relative and absolute")
      ->capture_default_str();
  std::vector<std::string> names;
  for (const auto& [name, value] : kStabilisations) names.emplace_back(name);
  command->add_option("--stabilisation", arguments->stabilisation,
                      "How closures are kept: none (phi'' = 0 alone), baumgarte, or projection after "
                      "each step")
      ->capture_default_str()
      ->check(CLI::IsMember(names));
  command->add_option("--baumgarte-rate", arguments->options.baumgarte_rate,
                      "w [1/s] in phi'' + 2 w phi' + w^2 phi = 0")
      ->capture_default_str();
  command->add_option("--outputs", arguments->options.outputs, "Rows of the CSV file")
      ->capture_default_str();
  command->add_option("--csv", arguments->csv, "File: time, q, qd, drift");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
