// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness envelope: guaranteed bounds over ranges of q, qd and qdd.
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/held_joints.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/share.hpp"
#include "crosscheck/cli/uncertain_parameters.hpp"
#include "crosscheck/reduction/envelope.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/envelope.hpp"
#include "scene/held_joints.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string json, along, masses = "0";
  bool nominal = false;
  EnvelopeOptions options;
};

int run(Arguments arguments) {
  requireWritableFile(arguments.json);
  scene::Scene scene =
      admitted(arguments.scene, Command::kEnvelope, scene::InertiaNeed::kOfNoJoint);
  requireMotion(scene);
  arguments.options.masses = shareOf("--masses-within", arguments.masses);
  if (!arguments.nominal)
    arguments.options.parameters = uncertainParametersOf(arguments.scene, scene);
  EnvelopeBoxes boxes;
  if (arguments.along.empty()) {
    boxes = {envelopeOf(arguments.scene, scene)};
    tellHeldJoints(scene::fixHeldJoints(&scene, &boxes.front()), scene);
  } else {
    boxes = boxesAlong(arguments.along, scene, arguments.options.quantities);
  }
  std::vector<EnvelopeBound> bounds;
  {
    Progress progress("bounds of " + scene.name);
    bounds = envelopeBounds(scene, boxes, arguments.options,
                            [&](const std::string& what) { progress.note(what); });
  }
  fmt::print("{}", envelopeText(scene, bounds, arguments.options));
  if (!arguments.json.empty())
    writeWholeFile(arguments.json,
                   envelopeJson(scene, boxes, bounds, arguments.options, DYNWITNESS_VERSION));
  return std::all_of(bounds.begin(), bounds.end(),
                     [](const EnvelopeBound& b) { return b.is_reached; })
             ? 0
             : 1;
}

}  // namespace

Run addEnvelope(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene,
           "Scene whose TOML file has [envelope]: a tree of turning and sliding joints");
  command
      ->add_option("--ratio", arguments->options.ratio,
                   "Of the bound to the largest that was seen: halve boxes until it is reached")
      ->capture_default_str()
      ->check(between(1.001, 1000));
  command
      ->add_option("--boxes", arguments->options.boxes,
                   "Boxes at most: for each quantity, whose bound stands as it is then")
      ->capture_default_str()
      ->check(whole(1, 100000000));
  command
      ->add_option(
          "--quantity", arguments->options.quantities,
          "Quantities: what is bounded, several with commas; tau, qdd (for the ranges of "
          "tau in [envelope]), M, c, g, T, V, energy (T + V), reactions (of joints that move)")
      ->delimiter(',')
      ->default_str("tau")
      ->check(oneOf(kEnvelopeQuantities));
  command->add_option("--along", arguments->along,
                      "CSV file of states q1.., qd1.., qdd1.. (of qdd: tau1..): a motion takes the "
                      "place of [envelope], the smallest box of each two rows after each other");
  command
      ->add_option("--masses-within", arguments->masses,
                   "Share, 5% or 0.05: each link that moves may be heavier or lighter by it, mass "
                   "and inertia together; not for qdd")
      ->capture_default_str();
  command->add_flag("--nominal", arguments->nominal,
                    "Parameters as they are: what [envelope.parameters] says is left out");
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness envelope puma_560\n"
      "  dynwitness envelope kuka_iiwa_14 --ratio 1.5\n"
      "  dynwitness envelope planar_3r --quantity qdd,energy --ratio 1.05 --json envelope.json\n"
      "  dynwitness envelope scara --gravity 0,0,-1.62 --masses-within 5%\n"
      "  dynwitness simulate planar_3r --duration 2 --csv motion.csv\n"
      "  dynwitness envelope planar_3r --along motion.csv --quantity energy,reactions\n"
      "'at most' is a proven bound of |x| over all of the envelope, roundings\n"
      "included; 'at least' is what the sweeps answer at the worst state that was\n"
      "seen. Along a file's motion it holds as far as that stays, between two rows,\n"
      "within the box of both. [envelope.parameters] of the file\n"
      "(m2 = { relative = 0.1 }) names parameters that may be another number; not for\n"
      "qdd. Exit status 1: the ratio was not reached within --boxes. --set of a\n"
      "parameter changes [envelope] where it stands there; a base that floats, by\n"
      "--root or --base, has no ranges there, and is refused.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
