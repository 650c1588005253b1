// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness rotors: what the model d = n^2 J of a rotor leaves out.
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/rotor_models.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/verdicts/options.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string json;
  int states = Options().states;
  std::uint64_t seed = Options().seed;
};

std::string jsonOf(const scene::Scene& scene, const RotorModels& models) {
  nlohmann::json out = {{"dynwitness", DYNWITNESS_VERSION},
                        {"scene", scene.name},
                        {"states", models.states},
                        {"seed", models.seed}};
  for (const RotorModels::Joint& joint : models.joints)
    out["joints"].push_back({{"name", joint.name},
                             {"has_rotor", joint.has_rotor},
                             {"largest_tau_difference", joint.largest},
                             {"at_state", joint.worst_state},
                             {"largest_tau", joint.largest_tau},
                             {"share_of_largest_tau", joint.share()},
                             {"with_ten_times_the_gear_ratio", joint.at_ten_times}});
  return out.dump(2) + "\n";
}

int run(const Arguments& arguments) {
  requireWritableFile(arguments.json);
  const scene::Scene scene =
      admitted(arguments.scene, Command::kRotors, scene::InertiaNeed::kOfNoJoint);
  requireMotion(scene);
  const RotorModels models = compareRotorModels(scene, arguments.states, arguments.seed);
  for (const RotorModels::Joint& joint : models.joints)
    if (!std::isfinite(joint.largest) || !std::isfinite(joint.at_ten_times) ||
        !std::isfinite(joint.share()))
      throw scene::InputError({scene.file.string()},
                              joint.name + ": tau is not finite, allowed: numbers that have one");
  fmt::print(
      "{}: tau with gyroscopic rotors less tau with n^2 J alone, {} states of seed {}\n"
      "(N m, N for slides; the last column: 10 times the gear ratio, n^2 J as it is)\n\n"
      "{:<24} {:>12} {:>8} {:>12} {:>10} {:>12}\n",
      scene.name, models.states, models.seed, "joint", "largest", "at state", "largest tau",
      "share", "10 n");
  for (const RotorModels::Joint& joint : models.joints)
    fmt::print("{:<24} {:>12.4g} {:>8} {:>12.4g} {:>9.3g}% {:>12.4g}{}\n", joint.name,
               joint.largest, joint.worst_state, joint.largest_tau, 100 * joint.share(),
               joint.at_ten_times, joint.has_rotor ? "" : "  no rotor");
  fmt::print(
      "\nNo difference where the link that carries a rotor does not turn; at a given n^2 J it "
      "falls as 1/n.\n");
  if (!arguments.json.empty()) writeWholeFile(arguments.json, jsonOf(scene, models));
  return 0;
}

}  // namespace

Run addRotors(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene with rotors");
  addRandom(*command, arguments->states, 1000000, "where the coupling is measured");
  addSeed(*command, arguments->seed, "of the states");
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n  dynwitness rotors puma_560\n"
      "  dynwitness rotors gyroscopic_wrist --random 1000 --json rotors.json");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
