// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness impulse: what a blow does to velocities, momentum and energy.
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/findings.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/cli/state_options.hpp"
#include "crosscheck/motion/closure_gap.hpp"
#include "crosscheck/motion/constrained_quantities.hpp"
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/impulse.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string json;
  std::optional<StateOption> q, qd;
  std::vector<double> at, force, moment, direction;
  ImpulseOptions options;
};

/// Closures may be torn at by rates, which the blow then takes; but their positions have to be
/// closed.
void tellOpenClosures(const scene::Scene& scene, const std::vector<double>& q) {
  if (scene.mechanism.closures.empty()) return;
  scene::State<double> state = ConstrainedQuantities(scene).start();
  if (q.size() == state.x.size())
    for (std::size_t i = 0; i < q.size(); ++i) state.x[i] = scene::jointPosition(q[i]);
  state.qd.assign(state.qd.size(), 0.0);
  const ClosureGap gap = ClosureGaps(scene).at(state);
  if (gap.is_open)
    tell(fmt::format(
        "{}: closures are open, |phi| = {:.3g}: what is said is not about the closed mechanism\n",
        scene.name, gap.phi));
}

int run(Arguments arguments) {
  requireWritableFile(arguments.json);
  const scene::Scene scene = admitted(arguments.scene, Command::kImpulse);
  ImpulseOptions& options = arguments.options;
  options.q = arguments.q->values(scene, inDouble(scene, scene.start_q));
  options.qd = arguments.qd->values(scene, inDouble(scene, scene.start_qd));
  put("--at", arguments.at, &options.at);
  put("--impulse", arguments.force, &options.force);
  put("--moment", arguments.moment, &options.moment);
  put("--wall", arguments.direction, &options.direction);
  const bool is_impact = !arguments.direction.empty();
  if (is_impact &&
      (!arguments.force.empty() || !arguments.moment.empty() || !options.joints.empty()))
    throw scene::InputError({},
                            "--wall seeks the impulse itself, allowed: without --impulse, --moment "
                            "and --joint-impulses");
  if (is_impact && options.direction == std::array<double, 3>{})
    throw scene::InputError({}, "--wall: 0,0,0 is no direction");
  if (!is_impact && arguments.force.empty() && arguments.moment.empty() && options.joints.empty() &&
      scene.mechanism.closures.empty())
    options.force = {0, 0, 1};  // something to look at
  tellOpenClosures(scene, options.q);
  std::optional<Progress> progress(std::in_place, 2, 1.0);
  progress->stage("impulse of " + scene.name);
  const ImpulseResult result = strike(scene, options);
  requireFinite("qd after the blow", result.after);
  requireFinite("the impulse", result.impulse);
  requireFinite("impulses of closures", result.closures);
  requireFinite("momentum", result.momentum_jump);
  requireFinite("impulses to the world", result.support);
  requireFinite("energy",
                std::array{result.energy_before, result.energy_after, result.effective_mass});
  std::vector<CheckResult> checks = result.checks;
  progress->stage("exact checks");
  for (const CheckResult& check : checkImpulsesExactly(scene, options.link, {}))
    checks.push_back(check);
  progress.reset();

  fmt::print("{}: impulse {:.6g} N s, {:.6g} N m s at the point, world axes\n", scene.name,
             fmt::join(result.impulse.begin(), result.impulse.begin() + 3, ", "),
             fmt::join(result.impulse.begin() + 3, result.impulse.end(), ", "));
  const std::vector<std::string> names = scene.mechanism.rateLabels();
  fmt::print("velocities   before, after [rad/s, m/s]\n");
  for (std::size_t i = 0; i < result.before.size(); ++i)
    fmt::print("   {:>14.8g} {:>14.8g} {}   {}\n", result.before[i], result.after[i],
               boundText(result.after_bound[i]), names[i]);
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

Run addImpulse(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene");
  command->add_option("--link", arguments->options.link,
                      "Link: that is struck (default: the last)");
  command
      ->add_option("--at", arguments->at,
                   "Point of the link, its frame [m]: where it is struck, e.g. 0,0,0.1")
      ->check(finite())
      ->delimiter(',');
  command->add_option("--impulse", arguments->force, "Impulse at the point, world axes [N s]")
      ->check(finite())
      ->delimiter(',');
  command->add_option("--moment", arguments->moment, "Impulse of a moment, world axes [N m s]")
      ->check(finite())
      ->delimiter(',');
  command
      ->add_option("--joint-impulses", arguments->options.joints,
                   "Impulses of the joints [N m s, N s]")
      ->check(finite())
      ->delimiter(',');
  command
      ->add_option("--wall", arguments->direction,
                   "The point hits a wall with this normal, world axes: the impulse is sought")
      ->check(finite())
      ->delimiter(',');
  command
      ->add_option("--restitution", arguments->options.restitution,
                   "Of the impact: 0 plastic, 1 elastic")
      ->check(between(0, 1))
      ->capture_default_str();
  arguments->q.emplace(command, StateOption::Part::kQ, "the scene's start");
  arguments->qd.emplace(command, StateOption::Part::kQd, "before the blow; the scene's start");
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness impulse double_pendulum --at 0,0,-0.4 --impulse 1,0,0\n"
      "  dynwitness impulse puma_560 --qd 1,0.5,0,0,0,0 --wall 0,0,1 --restitution 0.5\n"
      "  dynwitness impulse andrews_squeezer --qd 1,0,0,0,0,0,0  # closures that bind at "
      "once\n"
      "The laws are checked at this state within rounding, and over a prime field for every state "
      "and\n"
      "impulse. Exit status 1: one fails.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
