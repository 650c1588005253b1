// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness impulse: what a blow does to velocities, momentum and energy.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/findings.hpp"
#include "crosscheck/studies/impulse.hpp"
#include "crosscheck/report/files.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  std::string scene, json;
  std::vector<double> at, force, moment, direction;
  ImpulseOptions options;
};

int run(Arguments arguments) {
  const scene::Scene scene = scene::findScene(arguments.scene);
  requireWritableFile(arguments.json);
  ImpulseOptions& options = arguments.options;
  put("--at", arguments.at, &options.at);
  put("--impulse", arguments.force, &options.force);
  put("--moment", arguments.moment, &options.moment);
  put("--wall", arguments.direction, &options.direction);
  const bool is_impact = !arguments.direction.empty();
  if (is_impact &&
      (!arguments.force.empty() || !arguments.moment.empty() || !options.joints.empty()))
    throw scene::InputError({},
                            "--wall seeks the impulse itself, allowed: without --impulse, --moment "
                            "and --joints");
  if (is_impact && options.direction == std::array<double, 3>{})
    throw scene::InputError({}, "--wall: 0,0,0 is no direction");
  if (!is_impact && arguments.force.empty() && arguments.moment.empty() && options.joints.empty() &&
      scene.mechanism.closures.empty())
    options.force = {0, 0, 1};  // something to look at
  const ImpulseResult result = strike(scene, options);
  std::vector<CheckResult> checks = result.checks;
  for (const CheckResult& check : checkImpulsesExactly(scene, options.link, {}))
    checks.push_back(check);

  fmt::print("{}: impulse {:.6g} N s, {:.6g} N m s at the point, world axes\n", scene.name,
             fmt::join(result.impulse.begin(), result.impulse.begin() + 3, ", "),
             fmt::join(result.impulse.begin() + 3, result.impulse.end(), ", "));
  const std::vector<std::string> names = scene.mechanism.rateLabels();
  fmt::print("velocities   before, after [rad/s, m/s]\n");
  for (std::size_t i = 0; i < result.before.size(); ++i)
    fmt::print("   {:>14.8g} {:>14.8g} +- {:.1g}   {}\n", result.before[i], result.after[i],
               result.after_bound[i], names[i]);
  fmt::print("point        before ({:.6g}), after ({:.6g}) m/s\n",
             fmt::join(result.point_before, ", "), fmt::join(result.point_after, ", "));
  if (is_impact)
    fmt::print("impact       effective mass {:.8g} kg, restitution {}\n", result.effective_mass,
               options.restitution);
  if (result.equations > 0)
    fmt::print("closures     {} equations, impulses of {} that stand for all: {:.6g}\n",
               result.equations, result.closures.size(), fmt::join(result.closures, ", "));
  fmt::print("energy       {:.8g} J before, {:.8g} J after\n", result.energy_before,
             result.energy_after);
  fmt::print(
      "momentum     jumps by {:.6g} N s, {:.6g} N m s; of it through joints to the world {:.6g}, "
      "{:.6g}\n",
      fmt::join(result.momentum_jump.begin(), result.momentum_jump.begin() + 3, ", "),
      fmt::join(result.momentum_jump.begin() + 3, result.momentum_jump.end(), ", "),
      fmt::join(result.support.begin(), result.support.begin() + 3, ", "),
      fmt::join(result.support.begin() + 3, result.support.end(), ", "));
  const int status = printFindings(checks);
  if (!arguments.json.empty()) {
    const Json json{{"qd_before", result.before},
                    {"qd_after", result.after},
                    {"qd_after_bound", result.after_bound},
                    {"point_before_m_s", result.point_before},
                    {"point_after_m_s", result.point_after},
                    {"impulse_N_s_N_m_s", result.impulse},
                    {"closure_impulses", result.closures},
                    {"momentum_jump", result.momentum_jump},
                    {"support_impulse", result.support},
                    {"energy_before_J", result.energy_before},
                    {"energy_after_J", result.energy_after},
                    {"effective_mass_kg", result.effective_mass}};
    writeWholeFile(arguments.json, findingsJson("impulse", scene, json, checks));
  }
  return status;
}

}  // namespace

Run addImpulse(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "impulse", "A blow on a link, on joints or against a wall: velocities, momentum, energy");
  command->add_option("scene", arguments->scene, "Scene")->required();
  command->add_option("--link", arguments->options.link, "Link that is struck (default: the last)");
  command->add_option("--at", arguments->at, "Point of the link, its frame [m], e.g. 0,0,0.1")
      ->delimiter(',');
  command->add_option("--impulse", arguments->force, "Impulse at the point, world axes [N s]")
      ->delimiter(',');
  command->add_option("--moment", arguments->moment, "Impulse of a moment, world axes [N m s]")
      ->delimiter(',');
  command->add_option("--joints", arguments->options.joints, "Impulses of the joints [N m s, N s]")
      ->delimiter(',');
  command
      ->add_option("--wall", arguments->direction,
                   "The point hits a wall with this normal, world axes: the impulse is sought")
      ->delimiter(',');
  command
      ->add_option("--restitution", arguments->options.restitution,
                   "Of the impact: 0 plastic, 1 elastic")
      ->capture_default_str();
  command->add_option("--state", arguments->options.q, "Position q (default: the scene's start)")
      ->delimiter(',');
  command->add_option("--velocity", arguments->options.qd, "qd before (default: the scene's start)")
      ->delimiter(',');
  command->add_option("--json", arguments->json, "Write the result to this file");
  command->footer(
      "Examples:\n"
      "  dynwitness impulse double_pendulum --at 0,0,-0.4 --impulse 1,0,0\n"
      "  dynwitness impulse puma_560 --velocity 1,0.5,0,0,0,0 --wall 0,0,1 --restitution 0.5\n"
      "  dynwitness impulse andrews_squeezer --velocity 1,0,0,0,0,0,0    closures that bind at "
      "once\n"
      "The laws are checked at this state within rounding, and over a prime field for every state "
      "and\n"
      "impulse. Exit status 1: one fails.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
