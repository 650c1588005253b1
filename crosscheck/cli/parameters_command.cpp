// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness parameters: which inertial parameters a scene's motion knows, and how uncertain ones
// matter.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/parameters/parameters.hpp"
#include "crosscheck/parameters/parameters_report.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {
namespace {

struct Arguments {
  GivenScene scene;
  std::string json;
  crosscheck::ParametersOptions options;
};

int run(const Arguments& arguments) {
  crosscheck::requireWritableFile(arguments.json);
  const scene::Scene scene = admitted(arguments.scene, crosscheck::Command::kParameters);
  const crosscheck::ParametersResult result = [&] {
    const Progress progress("parameters of " + scene.name);
    return crosscheck::examineParameters(scene, arguments.options);
  }();
  fmt::print("{}", crosscheck::parametersText(result));
  if (!arguments.json.empty())
    crosscheck::writeWholeFile(arguments.json,
                               crosscheck::parametersJson(result, DYNWITNESS_VERSION));
  return result.agrees() ? 0 : 1;
}

}  // namespace

Run addParameters(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  crosscheck::ParametersOptions& options = arguments->options;
  addScene(*command, arguments->scene, "Scene");
  addRandom(*command, options.states, 10000, "Y is stacked over these");
  addSeed(*command, options.seed, "of points, states and draws");
  command->add_option(
      "--uncertainty", options.uncertainty,
      "Standard deviations: NAME=NUMBER,... of mass, inertia, rotor (relative), com, xyz [m], "
      "rpy [rad]");
  command->add_option("--samples", options.samples, "Monte Carlo draws for --uncertainty")
      ->check(whole(100, 10000000))
      ->capture_default_str();
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness parameters double_pendulum\n"
      "  dynwitness parameters puma_560 --uncertainty "
      "mass=0.05,com=0.002,inertia=0.1,xyz=0.001,rpy=0.002\n"
      "Errors: mass, of each link's density; com and xyz, along each axis, of each centre of mass "
      "and each\n"
      "joint; inertia, of each entry of I, as a share of the link's largest moment about its "
      "centre of mass;\n"
      "rpy, about each axis of each joint. All independent and normally distributed.\n"
      "Exit status 1: two ways to the same number disagree.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
