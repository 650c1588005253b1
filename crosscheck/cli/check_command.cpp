// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness check: somebody's program, or formulas, on the stand. Right, or where wrong, and why?
#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>

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
#include "crosscheck/diagnosis/formulas_report.hpp"
#include "crosscheck/diagnosis/recorded.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/scene.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  GivenScene scene;
  std::string scalar = "double", format = "text", output, smallest, answers, states, convention;
  std::vector<std::string> engines, formulas;
  Limits limits;
  CheckOptions options;
};

/// A program, or what is in files.
WitnessKind kindFor(const scene::Scene& scene, Arguments& arguments) {
  if (arguments.answers.empty() && arguments.engines.empty())
    throw scene::InputError(
        {}, "nobody to ask, expected --engine COMMAND, --answers FILE or --answer FORMULA");
  if (arguments.answers.empty())
    return engineKinds(arguments.engines, arguments.limits, scene).front();
  std::optional<CoordinateConvention> convention;
  if (!arguments.convention.empty()) convention = conventionNamed(arguments.convention);
  Recorded recorded = readRecorded(scene, arguments.answers, arguments.states, convention);
  arguments.options.states = recorded.states;
  return recordedKind(std::move(recorded), arguments.answers);
}

/// Lines of a file that are formulas; none: it is a table of numbers, in which no "=" can stand.
std::vector<StatedFormula> formulasIn(const std::string& file) {
  std::vector<StatedFormula> out;
  if (file.empty() || file == "-") return out;
  std::istringstream lines(scene::readTextFile(file, "a CSV file of answers, or formulas"));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (out.empty() && line.find('=') == std::string::npos) return {};
    out.push_back({line, {file, number}});
  }
  return out;
}

int runFormulas(const Arguments& arguments, std::vector<StatedFormula> formulas) {
  for (const auto& [option, is_given] : {std::pair("--states", !arguments.states.empty()),
                                         std::pair("--convention", !arguments.convention.empty()),
                                         std::pair("--smallest", !arguments.smallest.empty()),
                                         std::pair("--scalar", arguments.scalar != "double")})
    if (is_given)
      throw scene::InputError(
          {}, fmt::format("{} with formulas, which have neither states nor roundings, allowed: "
                          "--answer, --answers, --seed, --format, -o",
                          option));
  for (const std::string& text : arguments.formulas) formulas.push_back({text, {"--answer", 0}});
  const scene::Scene scene =
      admitted(arguments.scene, Command::kCheckFormulas, scene::InertiaNeed::kOfNoJoint);
  requireMotion(scene);
  std::optional<Progress> progress(std::in_place, "check of " + scene.name);
  const JudgedFormulas judged = judgeFormulas(scene, formulas, arguments.options.seed);
  progress.reset();
  const bool json = arguments.format == "json";
  const std::string text = json ? formulasJson(judged, DYNWITNESS_VERSION) : formulasText(judged);
  if (arguments.output.empty())
    fmt::print("{}", text);
  else
    writeWholeFile(arguments.output, text);
  return judged.isRight() ? 0 : 1;
}

int run(Arguments arguments) {
  requireWritableFile(arguments.output);
  requireWritableFile(arguments.smallest);
  const std::vector<StatedFormula> formulas = formulasIn(arguments.answers);
  if (!formulas.empty() || !arguments.formulas.empty()) return runFormulas(arguments, formulas);
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
  if (!found.failure.empty() && !arguments.engines.empty())
    tell(fmt::format("{} has {:g} s for each answer (--engine-seconds)\n", found.engine,
                     arguments.limits.seconds));
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
                       "qdd1.. beside them; every row is judged. Or a text file of formulas as "
                       "--answer takes them, one a line, comments after #")
          ->excludes(engine);
  command
      ->add_option("--answer", arguments->formulas,
                   "Formula in place of a program: a quantity as derive prints it (T, V, p1, M12, "
                   "Gamma112, c1, g1, tau1), =, and numbers, the scene's parameters, q1.., qd1.., "
                   "qdd1.., + - * / ^, cos and sin of sums of angles; repeatable")
      ->type_name("FORMULA")
      ->allow_extra_args(false)
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
      "Examples:\n"
      "  dynwitness check puma_560 --engine \"python3 data/engines/open_chain.py\"\n"
      "  dynwitness check puma_560 --states states.csv --answers tau.csv\n"
      "  dynwitness check double_pendulum --answer \"M12 = m2*l1*l2*cos(q2)/2\"\n"
      "  dynwitness check double_pendulum --answers formulas.txt\n"
      "At most ten states are asked. Each answer is judged by what an algorithm of its kind may "
      "lose; where it\n"
      "is wrong, each mistake on record is put into a textbook's formulas, and what these then say "
      "is compared\n"
      "with what the program says, to the last digits. A formula is decided exactly, for all "
      "values of the scene's\n"
      "parameters: right, right but for a sign or factor, another quantity, or wrong at which "
      "terms.\n"
      "The last line names what was judged, unless all was: right in M and g; not answered: c.\n"
      "Exit status: 0 right in all that was answered; 1 wrong, or the program failed.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
