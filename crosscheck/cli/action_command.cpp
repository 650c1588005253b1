// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness action: Hamilton's principle on a simulated motion.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/findings.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/state_options.hpp"
#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/hamilton.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string json;
  std::optional<StateOption> q, qd;
  ActionOptions options;
};

Json toJson(const Action& action) {
  Json json{{"duration_s", action.duration},
            {"steps", action.steps},
            {"action_J_s", action.action},
            {"conservative", action.conservative}};
  if (action.conservative) json["energy_drift_J"] = action.energy_drift;
  json["paths"] = Json::array();
  for (const Action::Path& path : action.paths)
    json["paths"].push_back({{"name", path.name},
                             {"amplitude", path.amplitude},
                             {"first_variation_J_s", path.first},
                             {"change_J_s", path.change},
                             {"change_unsure_J_s", path.unsure}});
  if (!action.conservative) {
    json["first_variation_with_work_J_s"] = action.with_work;
    return json;
  }
  json["conjugate_times"] = Json::array();
  for (const Action::Conjugate& conjugate : action.conjugates)
    json["conjugate_times"].push_back(
        {{"time_s", conjugate.time},
         {"multiplicity", conjugate.multiplicity},
         {"error_s", std::isfinite(conjugate.error) ? Json(conjugate.error) : Json("inf")}});
  if (action.negative >= 0) {
    json["negative_directions"] = action.negative;
    json["lowest_eigenvalue"] = action.lowest;
  }
  return json;
}

/// Every check agrees: the steps follow the motion and its neighbours.
bool isSure(const Action& action) {
  return std::all_of(action.checks.begin(), action.checks.end(),
                     [](const CheckResult& check) { return check.verdict == Verdict::kAgree; });
}

int run(Arguments arguments) {
  requireWritableFile(arguments.json);
  const scene::Scene scene = admitted(arguments.scene, Command::kAction);
  arguments.options.q = arguments.q->values(scene, inDouble(scene, scene.start_q));
  arguments.options.qd = arguments.qd->values(scene, inDouble(scene, scene.start_qd));
  if (surfaceNear(scene, arguments.options.q, arguments.options.qd).rates.empty()) {
    fmt::print("{}: closures leave nothing free to move: there is one path\n", scene.name);
    if (!arguments.json.empty())
      writeWholeFile(arguments.json, findingsJson("action", scene, Json{{"freedoms", 0}}, {}));
    return 0;
  }
  const Action action = [&] {
    const Progress progress("action of " + scene.name);
    return measureAction(scene, arguments.options);
  }();
  requireFinite("the action",
                std::array{action.action, action.energy_drift, action.with_work, action.lowest});
  for (const Action::Path& path : action.paths)
    requireFinite("the action of a varied path", std::array{path.first, path.change, path.unsure});
  fmt::print("{}: {} s in {} steps of order 4\n", scene.name, action.duration, action.steps);
  fmt::print("action       S = integral of T - V = {:.12g} J s\n", action.action);
  fmt::print("paths near   first variation for amplitude 1, and S(q + eta) - S(q)\n");
  for (const Action::Path& path : action.paths)
    fmt::print("  {:<10} {:>10.2g} J s {:>+12.4g} +- {:.1g} J s for amplitude {:g}{}\n", path.name,
               path.first, path.change, path.unsure, path.amplitude,
               path.kind == Action::Path::Kind::kDrawn ? ""
               : !path.isSure()                        ? ", not decided"
               : path.change < 0                       ? ", lower"
                                                       : ", higher");
  if (action.conservative) {
    fmt::print("energy       |E - E0| {:.2g} J\n", action.energy_drift);
    if (action.conjugates.empty())
      fmt::print("conjugate    no conjugate time {} {} s{}\n", isSure(action) ? "in" : "seen in",
                 action.duration, isSure(action) ? ": the action is least" : "");
    for (const Action::Conjugate& conjugate : action.conjugates)
      fmt::print("conjugate    t = {:.10g} s {} s\n", conjugate.time, boundText(conjugate.error));
    if (action.negative >= 0)
      fmt::print(
          "second       variation: {} negative directions; lowest eigenvalue {:.6g} of the kinetic "
          "part\n",
          action.negative, action.lowest);
  } else {
    // dS alone does not vanish, and neither does it with W beside T - V
    const bool stays = action.with_work > action.with_work_coarse / 8;
    fmt::print("with work    T - V + W in place of T - V: first variation {:.3g} J s, {}\n",
               action.with_work,
               stays ? "not stationary: work is no part of a Lagrangian"
                     : "stationary too: these forces are constant along every joint");
  }
  const int status = printFindings(action.checks);
  if (!arguments.json.empty())
    writeWholeFile(arguments.json, findingsJson("action", scene, toJson(action), action.checks));
  return status;
}

}  // namespace

Run addAction(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene");
  command
      ->add_option("--duration", arguments->options.duration,
                   "Duration [s]: between the end points")
      ->check(positive())
      ->capture_default_str();
  arguments->q.emplace(command, StateOption::Part::kQ, "the scene's start");
  arguments->qd.emplace(command, StateOption::Part::kQd, "the scene's start");
  command
      ->add_option("--friction", arguments->options.damping,
                   "Of every joint, force -friction qd [N m s/rad, N s/m]")
      ->check(nonNegative())
      ->capture_default_str();
  command->add_option("--paths", arguments->options.paths, "How many varied paths")
      ->check(whole(1, 10000))
      ->capture_default_str();
  addSeed(*command, arguments->options.seed, "of the varied paths");
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness action simple_pendulum --duration 1    # less than half a period: S is least\n"
      "  dynwitness action simple_pendulum --duration 2    # beyond the conjugate time: a saddle\n"
      "  dynwitness action double_pendulum --friction 0.1   # d'Alembert and Lagrange: dS + Q' eta = "
      "0\n"
      "Exit status 1: a check found a disagreement.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
