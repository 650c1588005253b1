// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness check: somebody's program on the stand. Is it right, where is it wrong, and why?
#include <algorithm>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/given_states.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/speech.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/diagnosis/check_report.hpp"
#include "crosscheck/diagnosis/examine.hpp"
#include "crosscheck/diagnosis/recorded.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string scalar = "double", format = "text", output, smallest, answers, states, convention;
  std::vector<std::string> engines;
  Limits limits;
  CheckOptions options;
};

/// A program, or what is in files.
WitnessKind kindFor(const scene::Scene& scene, Arguments& arguments) {
  if (arguments.answers.empty() && arguments.engines.empty())
    throw scene::InputError({}, "nobody to ask, expected --engine COMMAND or --answers FILE");
  if (arguments.answers.empty())
    return engineKinds(arguments.engines, arguments.limits, scene).front();
  std::optional<CoordinateConvention> convention;
  if (!arguments.convention.empty()) convention = conventionNamed(arguments.convention);
  Recorded recorded = readRecorded(scene, arguments.answers, arguments.states, convention);
  arguments.options.states = recorded.states;
  return recordedKind(std::move(recorded), arguments.answers);
}

int run(Arguments arguments) {
  requireWritableFile(arguments.output);
  requireWritableFile(arguments.smallest);
  const scene::Scene whole = admitted(arguments.scene, Command::kCheck);
  requireMotion(whole);
  if (!arguments.answers.empty() && whole.mechanism.hasMimics())
    throw scene::InputError({whole.file.string(), 0},
                            "--answers of a scene whose joints follow others, allowed: --engine");
  const scene::Scene scene = withoutFollowers(whole);
  arguments.options.single = arguments.scalar == "float";
  std::optional<Progress> progress(std::in_place, "check of " + scene.name);
  const WitnessKind kind = kindFor(scene, arguments);
  const Examination found = examine(scene, kind, arguments.options);
  progress.reset();
  const std::string text =
      arguments.format == "json" ? checkJson(found, DYNWITNESS_VERSION) : checkText(found);
  if (arguments.output.empty())
    fmt::print("{}", arguments.format == "json" ? text : tonedReport(text));
  else
    writeWholeFile(arguments.output, text);
  if (!arguments.smallest.empty() && found.smallest)
    writeWholeFile(arguments.smallest, scene::writeSceneToml(found.smallest->scene));
  return found.isWrong() ? 1 : 0;
}

}  // namespace

Run addCheck(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  addScene(*command, arguments->scene, "Scene");
  CLI::Option* const engine =
      addEngineOptions(*command, arguments->engines, arguments->limits)->expected(1);
  CLI::Option* const answers =
      command
          ->add_option("--answers", arguments->answers,
                       "CSV file in place of a program: answers in columns as evaluate writes them "
                       "(tau1.., M11.., c1.., g1.., kinetic, potential, momentum1.., JOINT.fx to "
                       "JOINT.mz: reactions), q1.., qd1.., "
                       "qdd1.. beside them; every row is judged")
          ->excludes(engine);
  command
      ->add_option("--states", arguments->states,
                   "States, a CSV file: of these answers, row by row, where they do not stand "
                   "beside them (qdd1.. may be answers then, too: of tau1.. here)")
      ->needs(answers);
  addConvention(*command, arguments->convention,
                "in states and answers of these files (`evaluate --help`)")
      ->needs(answers);
  command
      ->add_option("--scalar", arguments->scalar,
                   "Arithmetic: whose roundings are allowed, of double or of single precision")
      ->capture_default_str()
      ->check(oneOf({"double", "float"}));
  addSeed(*command, arguments->options.seed, "of the states")->excludes(answers);
  command->add_option("--format", arguments->format, "How it is written")
      ->capture_default_str()
      ->check(oneOf({"text", "json"}));
  addOutput(*command, arguments->output, "file; without: standard output");
  command
      ->add_option("--smallest", arguments->smallest,
                   "Where nothing on record explains it: write the smallest scene that is still "
                   "answered wrongly to this file")
      ->excludes(answers);
  command->footer(
      "dynwitness check puma_560 --engine \"python3 data/engines/open_chain.py\"\n"
      "dynwitness check puma_560 --states states.csv --answers tau.csv\n"
      "At most ten states are asked. Each answer is judged by what an algorithm of its kind may "
      "lose; where it\n"
      "is wrong, each mistake on record is put into a textbook's formulas, and what these then say "
      "is compared\n"
      "with what the program says, to the last digits. Exit status: 0 right; 1 wrong, or the "
      "program failed.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
