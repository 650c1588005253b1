// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness same: whether two descriptions are the same robot.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/remarks.hpp"
#include "crosscheck/readers/same.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/remarks.hpp"

namespace dynwitness::cli {
namespace {

struct Arguments {
  std::string a, b, json;
  int states = 20;
  std::uint64_t seed = 1;
};

int run(const Arguments& arguments) {
  crosscheck::requireWritableFile(arguments.json);
  for (const std::string& file : {arguments.a, arguments.b}) remark(scene::remarksOnFile(file));
  const crosscheck::SameResult result = crosscheck::compareDescriptions(
      crosscheck::findDescription(arguments.a), crosscheck::findDescription(arguments.b),
      arguments.states, arguments.seed);
  fmt::print("{}", crosscheck::sameText(result));
  if (!arguments.json.empty())
    crosscheck::writeWholeFile(arguments.json, crosscheck::sameJson(result, DYNWITNESS_VERSION));
  return result.isSame() ? 0 : 1;
}

}  // namespace

Run addSame(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command->add_option("a", arguments->a, "Scene, TOML, URDF or MJCF file")->required();
  command->add_option("b", arguments->b, "The other one")->required();
  addRandom(*command, arguments->states, 10000, "for what a difference does");
  addSeed(*command, arguments->seed, "of points and states");
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness same my_arm.urdf my_arm.toml\n"
      "  dynwitness same old.urdf new.urdf --json same.json\n"
      "Joints are matched by name, or by structure where names differ; link frames, order and fixed "
      "links may\n"
      "differ. Exit status: 0 the same robot; 1 different ones; 2 bad usage or input.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
