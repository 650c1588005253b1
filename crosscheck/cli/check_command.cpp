// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness check: somebody's program on the stand. Is it right, where is it wrong, and why?
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/diagnosis/check_report.hpp"
#include "crosscheck/diagnosis/examine.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

struct Arguments {
  std::string scene, scalar = "double", format = "text", output, smallest;
  std::vector<std::string> engines;
  Limits limits;
  CheckOptions options;
};

int run(Arguments arguments) {
  requireWritableFile(arguments.output);
  requireWritableFile(arguments.smallest);
  const scene::Scene scene = withoutFollowers(admitted(arguments.scene, Command::kCheck));
  requireMotion(scene);
  arguments.options.single = arguments.scalar == "float";
  std::optional<Progress> progress(std::in_place, "check of " + scene.name);
  const WitnessKind kind = engineKinds(arguments.engines, arguments.limits, scene).front();
  const Examination found = examine(scene, kind, arguments.options);
  progress.reset();
  const std::string text =
      arguments.format == "json" ? checkJson(found, DYNWITNESS_VERSION) : checkText(found);
  if (arguments.output.empty())
    fmt::print("{}", text);
  else
    writeWholeFile(arguments.output, text);
  if (!arguments.smallest.empty() && found.smallest)
    writeWholeFile(arguments.smallest, scene::writeSceneToml(found.smallest->scene));
  return found.isWrong() ? 1 : 0;
}

}  // namespace

Run addCheck(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "check", "A program of yours on the stand: is it right, where is it wrong, and why");
  command->add_option("scene", arguments->scene, "Scene")->required();
  addEngineOptions(*command, arguments->engines, arguments->limits)->required()->expected(1);
  command
      ->add_option("--scalar", arguments->scalar,
                   "Arithmetic whose roundings are allowed: of double or of single precision")
      ->capture_default_str()
      ->check(CLI::IsMember({"double", "float"}));
  command->add_option("--seed", arguments->options.seed, "Seed of the states")
      ->check(seed())
      ->capture_default_str();
  command->add_option("--format", arguments->format, "How to write it")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->add_option("-o,--output", arguments->output, "File; without: standard output");
  command->add_option("--smallest", arguments->smallest,
                      "Where nothing on record explains it: write the smallest scene that is still "
                      "answered wrongly to this file");
  command->footer(
      "dynwitness check puma_560 --engine \"python3 data/engines/open_chain.py\"\n"
      "At most ten states are asked. Each answer is judged by what an algorithm of its kind may "
      "lose; where it\n"
      "is wrong, each mistake on record is put into a textbook's formulas, and what these then say "
      "is compared\n"
      "with what the program says, to the last digits. Exit status: 0 right; 1 wrong, or the "
      "program failed.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
