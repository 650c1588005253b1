// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness need: a ladder from point masses to the scene, along its own motion.
#include <memory>

#include <fmt/format.h>

#include "crosscheck/cli/chart_files.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/given_states.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/reduction/ladder.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  StartAsked start;
  std::string json, folder;
  LadderOptions options;
  PictureLook look;
};

/// Error against operations, a point a rung with its name beside it.
std::string ladderScript(const scene::Scene& scene, const Ladder& ladder, const std::string& stem) {
  return chartScript(
      scene, "what each part of the model is for", stem,
      fmt::format(
          "set xlabel 'operations of inverse dynamics, friction apart'\n"
          "set ylabel 'forces that are missed at worst  [% of the joint''s largest]'\n"
          "set yrange [0:*]\nset offsets graph 0.1, graph 0.3, graph 0.1, 0\nset key top right\n"
          "plot '{0}.csv' using 2:(100*$4) skip 1 with linespoints linetype 1 pointtype 7 title "
          "'against the scene, over its motion of {1} s', \\\n"
          "     '' using 2:(100*$4):1 skip 1 with labels left offset 1,0.6 textcolor rgb ink "
          "notitle\n",
          stem, ladder.duration));
}

int run(const Arguments& arguments) {
  requireWritableFile(arguments.json);
  if (!arguments.folder.empty()) requireWritableFolder(arguments.folder);
  const scene::Scene scene = startedAt(admitted(arguments.scene, Command::kNeed), arguments.start);
  requireMotion(scene);
  Ladder ladder;
  {
    Progress progress("ladder of " + scene.name);
    ladder =
        ladderOf(scene, arguments.options, [&](const std::string& what) { progress.note(what); });
  }
  fmt::print("{}", ladderText(scene, ladder));
  if (!arguments.json.empty())
    writeWholeFile(arguments.json,
                   ladderJson(scene, ladder, arguments.options, DYNWITNESS_VERSION));
  if (!arguments.folder.empty()) {
    const std::string stem = safeName(scene.name) + "_ladder";
    writeCharts({{stem, ladderCsv(ladder)}}, {{stem, ladderScript(scene, ladder, stem)}},
                arguments.folder, arguments.look);
  }
  return 0;
}

}  // namespace

Run addNeed(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene");
  addStart(*command, arguments->start);
  command
      ->add_option("--duration", arguments->options.duration,
                   "Duration [s]: of the scene's motion, and of each rung's")
      ->check(positive())
      ->capture_default_str();
  command->add_option(
      "--chart", arguments->folder,
      "Folder: operations against error, a point a rung, as a table, CSV and a picture");
  addPictures(*command, arguments->look);
  addJson(*command, arguments->json);
  command->footer(
      "Examples:\n"
      "  dynwitness need puma_560\n"
      "  dynwitness need furuta_pendulum --duration 3 --qd 5,0 --chart ladder\n"
      "Point masses, then moments and products of inertia, rotors, their spin, friction: what each\n"
      "rung costs, what joint forces miss without it at the states of the scene's own motion, and\n"
      "how long a model without it moves as the scene does. A motion with reactions, drives or\n"
      "closures keeps them in every rung. What holds over a whole envelope: dynwitness reduce.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
