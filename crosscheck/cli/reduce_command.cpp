// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness reduce: a smaller model whose forces stay near the scene's.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/held_joints.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/share.hpp"
#include "crosscheck/cli/uncertain_parameters.hpp"
#include "crosscheck/reduction/reduce.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"
#include "scene/envelope.hpp"
#include "scene/held_joints.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string json, c, toml, front, allowed = "1%", of = "tau";
  ReduceOptions options;
  PictureLook look;
};

/// Operations against certified error, two curves.
std::string frontScript(const scene::Scene& scene, const std::string& stem, ReducedQuantity of) {
  const bool is_tau = of == ReducedQuantity::kTau;
  return chartScript(
      scene, "how small a model may be", stem,
      fmt::format(
          "set xlabel 'error of a joint {1}, certified over the envelope  [% of its largest]'\n"
          "set ylabel 'operations of {2} dynamics'\n"
          "set yrange [0:*]\nset xrange [0:*]\nset key top right\n"
          "plot '{0}.csv' using (100*$6):5 with linespoints linetype 1 pointtype 7 title 'a smaller "
          "scene'{3}\n",
          stem, is_tau ? "force" : "acceleration", is_tau ? "inverse" : "forward",
          is_tau ? fmt::format(", \\\n     '{}.csv' using (100*$3):2 with linespoints linetype 2 "
                               "pointtype 5 title 'and terms added to it'",
                               stem)
                 : ""));
}

int run(Arguments arguments) {
  if (arguments.of == "trajectory")
    throw scene::InputError(
        {},
        "--of trajectory: from bounds over an envelope a motion's error follows only as one that "
        "grows with exp(L t), L the Lipschitz constant of qdd there, and says nothing after a few "
        "tenths of a second; allowed: tau, qdd; dynwitness advise measures how far motions end");
  arguments.options.of = arguments.of == "qdd" ? ReducedQuantity::kQdd : ReducedQuantity::kTau;
  for (const std::string& file : {arguments.json, arguments.c, arguments.toml})
    requireWritableFile(file);
  if (!arguments.front.empty()) requireWritableFolder(arguments.front);
  const bool is_front = !arguments.front.empty();
  arguments.options.allowed = {static_cast<double>(shareOf("--tolerance", arguments.allowed))};
  if (is_front) {
    if (!arguments.c.empty() || !arguments.toml.empty())
      throw scene::InputError(
          {}, "--front: many models, allowed: --c and --toml of one, with --tolerance");
    arguments.options.allowed = {0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1};
  }
  scene::Scene scene = admitted(arguments.scene, Command::kReduce);
  requireMotion(scene);
  std::vector<scene::JointRanges> ranges = envelopeOf(arguments.scene, scene);
  tellNominalParameters(arguments.scene, scene);
  const std::string uncertain =
      arguments.toml.empty()
          ? ""
          : scene::writeUncertainParameters(uncertainParametersOf(arguments.scene, scene));
  tellHeldJoints(scene::fixHeldJoints(&scene, &ranges), scene);
  Reduction reduction;
  {
    Progress progress("reduction of " + scene.name);
    reduction = reduced(scene, ranges, arguments.options,
                        [&](const std::string& what) { progress.note(what); });
  }
  fmt::print("{}", reductionText(scene, reduction));
  if (!arguments.json.empty())
    writeWholeFile(arguments.json, reductionJson(scene, reduction, DYNWITNESS_VERSION));
  if (!arguments.c.empty())
    writeWholeFile(arguments.c, reductionC(scene, reduction.models.front(), reduction.of));
  if (!arguments.toml.empty())
    writeWholeFile(arguments.toml, scene::writeSceneToml(reduction.scenes.front().scene) +
                                       scene::writeEnvelope(scene, ranges) + uncertain);
  if (is_front) {
    const std::string stem = safeName(scene.name) + "_front";
    writeCharts({{stem, frontCsv(scene, reduction)}},
                {{stem, frontScript(scene, stem, reduction.of)}}, arguments.front, arguments.look);
  }
  return 0;
}

}  // namespace

Run addReduce(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene,
           "Scene whose TOML file has [envelope]: a tree of turning and sliding joints");
  CLI::Option* allowed =
      command
          ->add_option(
              "--tolerance", arguments->allowed,
              "Of each joint's largest |tau|, or |qdd|, in the envelope: how far it may be "
              "off")
          ->capture_default_str();
  command
      ->add_option("--of", arguments->of,
                   "What is kept near: tau for q, qd, qdd; or qdd for q, qd, tau, whose ranges "
                   "[envelope] then gives, by smaller scenes")
      ->capture_default_str()
      ->check(oneOf({"tau", "qdd", "trajectory"}));
  command
      ->add_option("--armstrong", arguments->options.armstrong,
                   "Beside it Armstrong's rule of 1986: terms go that are below this share of "
                   "their entry's largest, certified afterwards")
      ->check(between(1e-6, 1));
  command
      ->add_option("--boxes", arguments->options.boxes,
                   "Boxes at most: for the error of each joint's force in the end")
      ->capture_default_str()
      ->check(whole(1, 100000000));
  command->add_option("--c", arguments->c, "File: the reduced tau as a C function");
  command->add_option("--toml", arguments->toml,
                      "File: the best that is a scene and no more, for all other commands");
  command
      ->add_option("--front", arguments->front,
                   "Folder: allowed errors from 0 to 10 % as a table, CSV and a picture")
      ->excludes(allowed);
  addPictures(*command, arguments->look);
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness reduce puma_560 --tolerance 1% --c reduced.c --toml reduced.toml\n"
      "  dynwitness reduce puma_560 --front front\n"
      "  dynwitness reduce scara --armstrong 0.01\n"
      "  dynwitness reduce puma_560 --of qdd --tolerance 5% --toml reduced.toml\n"
      "'certified' is a proven bound of the error everywhere in the envelope, in % of\n"
      "that joint's largest force or acceleration; 'seen' is what sweep and program\n"
      "differ by at the worst state found. Left out: what friction and springs take, which stay.\n"
      "Time: planar arms and SCARA seconds; six joints half a minute, seven a minute, all\n"
      "that moves in humanoid (both arms) ten. Bounding what is left of terms that are added\n"
      "to a smaller scene takes four fifths of it; --of qdd has no terms.\n"
      "--set of a parameter changes [envelope] where it stands there; a base that floats, by\n"
      "--root or --base, has no ranges there, and is refused.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
