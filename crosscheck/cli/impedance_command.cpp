// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness impedance: stiffness, damping, compliance and inertia between joints and a point.
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
#include "crosscheck/studies/given_values.hpp"
#include "crosscheck/studies/impedance.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string json;
  std::optional<StateOption> q;
  std::vector<double> at, stiffness, damping, stretch;
  ImpedanceOptions options;
};

void print(const char* name, const char* what, const Bounded& m) {
  if (m.value.size() == 0) return;
  fmt::print("{:<12} {}\n", name, what);
  for (Eigen::Index i = 0; i < m.value.rows(); ++i) {
    fmt::print("  ");
    for (Eigen::Index j = 0; j < m.value.cols(); ++j) fmt::print(" {:>12.6g}", m.value(i, j));
    fmt::print("\n");
  }
}

/// Whether the point can move every way.
bool hasInertia(const ImpedanceAt& at) {
  return at.inertia.bound.allFinite() && at.inertia.value.allFinite();
}

int run(Arguments arguments) {
  requireWritableFile(arguments.json);
  const scene::Scene scene = admitted(arguments.scene, Command::kImpedance);
  ImpedanceOptions& options = arguments.options;
  options.q = arguments.q->values(scene, inDouble(scene, scene.start_q));
  put("--at", arguments.at, &options.at);
  put("--stiffness", arguments.stiffness, &options.stiffness);
  put("--damping", arguments.damping, &options.damping);
  put("--stretch", arguments.stretch, &options.stretch);
  std::optional<Progress> progress(std::in_place, 2, 1.0);
  progress->stage("impedance of " + scene.name);
  const ImpedanceAt at = impedanceAt(scene, options);
  requireFinite("the Jacobian", at.J.value);
  requireFinite("stiffness", at.stiffness.value);
  requireFinite("geometric stiffness", at.geometric.value);
  requireFinite("damping", at.damping.value);
  requireFinite("compliance", at.compliance.value);
  requireFinite("mobility", at.mobility.value);
  std::vector<CheckResult> checks = at.checks;
  progress->stage("exact checks");
  for (const CheckResult& check : checkImpedanceExactly(scene, options.link, {}))
    checks.push_back(check);
  progress.reset();

  fmt::print("{}: link {}, world axes, linear part first\n", scene.name,
             options.link.empty() ? scene.mechanism.links.back().name : options.link);
  print("Jacobian", "J: motion of the point = J qd", at.J);
  print("stiffness", "J' K J, of the joints [N m/rad, N/m]", at.stiffness);
  if (at.geometric.value.size() > 0 && !at.geometric.value.isZero(0))
    print("geometric", "(dJ'/dq) f, what the stretched spring adds", at.geometric);
  print("damping", "J' D J, of the joints [N m s/rad, N s/m]", at.damping);
  print("compliance", "J C_q J', of the point [m/N, rad/N; rad/N, rad/(N m)]", at.compliance);
  print("mobility", "J M^-1 J', of the point [1/kg ...]", at.mobility);
  if (hasInertia(at))
    print("inertia", "(J M^-1 J')^-1, of the point [kg]", at.inertia);
  else
    fmt::print("inertia      the point cannot move every way: some directions have none\n");
  const int status = printFindings(checks);
  if (!arguments.json.empty()) {
    Json json{{"jacobian", toJson(at.J)},
              {"joint_stiffness", toJson(at.stiffness)},
              {"joint_damping", toJson(at.damping)},
              {"compliance", toJson(at.compliance)},
              {"mobility", toJson(at.mobility)}};
    if (at.geometric.value.size() > 0) json["geometric_stiffness"] = toJson(at.geometric);
    if (hasInertia(at)) json["inertia"] = toJson(at.inertia);
    writeWholeFile(arguments.json, findingsJson("impedance", scene, json, checks));
  }
  return status;
}

}  // namespace

Run addImpedance(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene, a tree of links");
  command->add_option("--link", arguments->options.link,
                      "Link: whose point it is (default: the last)");
  command
      ->add_option("--at", arguments->at,
                   "Point of the link, its frame [m]: where spring and damper act")
      ->check(finite())
      ->delimiter(',');
  command
      ->add_option("--stiffness", arguments->stiffness,
                   "Of a spring at the point, along and about world axes [N/m, N m/rad] "
                   "(default: 1,1,1,0,0,0)")
      ->check(finite())
      ->delimiter(',');
  command->add_option("--stretch", arguments->stretch, "How far that spring is stretched [m]")
      ->check(finite())
      ->delimiter(',');
  command
      ->add_option("--damping", arguments->damping,
                   "Of a damper there [N s/m, N m s/rad] (default: 1,1,1,0,0,0)")
      ->check(finite())
      ->delimiter(',');
  command
      ->add_option("--joint-compliance", arguments->options.joint_compliance,
                   "Of the joints [rad/(N m), m/N] (default: 1 each)")
      ->check(finite())
      ->delimiter(',');
  arguments->q.emplace(command, StateOption::Part::kQ, "the scene's start");
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness impedance puma_560 --q 0.1,0.2,0.3,0.4,0.5,0.6 --stiffness "
      "500,500,100,0,0,0\n"
      "  dynwitness impedance double_pendulum --at 0,0,-0.4 --stiffness 100,0,100,0,0,0 --stretch "
      "0.1,0,0\n"
      "The laws are checked at this state within rounding, and over a prime field for every state, "
      "point\n"
      "and stiffness. Exit status 1: one fails.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
