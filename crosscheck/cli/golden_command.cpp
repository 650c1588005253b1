// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness golden: states and certified answers for other people's tests.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/diagnosis/examine.hpp"
#include "crosscheck/golden/golden.hpp"
#include "crosscheck/golden/golden_files.hpp"
#include "crosscheck/golden/hardest.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/witnesses/witnesses.hpp"
#include "scene/scene.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Format {
  const char* name;
  const char* ending;
  std::string (*write)(const Golden& golden, const std::string& version);
};
constexpr Format kFormats[] = {
    {"json", ".json", goldenJson}, {"csv", ".csv", goldenCsv}, {"c", ".h", goldenHeader}};
constexpr const char* kVerifiers[] = {"verify.py", "verify.cpp", "verify.mjs"};

struct Arguments {
  std::vector<std::string> scenes, quantities, formats;
  bool all = false, hardest = false;
  GivenScene given;  ///< without a name
  std::string output;
  GoldenOptions options;
};

std::vector<Format> formatsOf(const Arguments& arguments) {
  std::vector<Format> out;
  for (const Format& format : kFormats)
    if (std::count(arguments.formats.begin(), arguments.formats.end(), format.name) > 0 ||
        (arguments.formats.empty() && !arguments.output.empty()))
      out.push_back(format);
  if (out.empty()) out.push_back(kFormats[0]);
  return out;
}

[[noreturn]] void refuse(const std::string& what) {
  throw scene::InputError({}, what);
}

/// The scenes that were asked for, and of --all-scenes those that are refused, with the reasons.
struct Admitted {
  std::vector<scene::Scene> scenes;
  std::vector<std::vector<std::string>> left_out;  ///< one a scene
  Json refused = Json::object();
};
Admitted admitAll(const Arguments& arguments) {
  if (arguments.all != arguments.scenes.empty())
    refuse(arguments.all ? "scenes beside --all-scenes, allowed: one or the other"
                         : "no scene, allowed: SCENE... or --all-scenes");
  Admitted out;
  const auto take = [&](const scene::Scene& scene) {
    admit(scene, {Command::kGolden});
    requireMotion(scene);
    out.left_out.push_back(leftOut(scene, Command::kGolden));
    out.scenes.push_back(withoutFollowers(scene));
    if (scene.mechanism.hasMimics())  // where followers start is no start of the tree
      out.scenes.back().start_q = out.scenes.back().mechanism.restPosition();
  };
  for (const std::string& name : arguments.scenes) {
    GivenScene given = arguments.given;
    given.name = name;
    take(readScene(given));
  }
  if (arguments.all)
    for (const fs::path& file : scene::bundledScenes()) {
      const scene::Scene scene = scene::readScene(file);
      const std::vector<std::string> reasons = refusals(scene, Command::kGolden);
      if (reasons.empty()) {
        take(scene);
        continue;
      }
      out.refused[scene.name] = reasons;
      for (const std::string& reason : reasons)
        tell(fmt::format("{}: left out: {}\n", scene.name, reason));
    }
  std::set<std::string> names;
  for (const scene::Scene& scene : out.scenes)
    if (!names.insert(safeName(scene.name)).second)
      refuse(fmt::format("two scenes write files called '{}', allowed: one", safeName(scene.name)));
  return out;
}

Golden made(const scene::Scene& scene, const GoldenOptions& options,
            const std::vector<std::string>& left_out) {
  constexpr long kMany = 100000;
  constexpr double kBytes = 110, kMega = 1e6;
  Golden golden = goldenQuestions(scene, options);
  for (const std::string& sentence : golden.left_out)
    tell(fmt::format("{}: left out: {}\n", scene.name, sentence));
  golden.left_out.insert(golden.left_out.begin(), left_out.begin(), left_out.end());
  if (golden.numbers() > kMany)
    tell(fmt::format("{}: {} numbers to certify at {} states, about {:.0f} MB in each format\n",
                     scene.name, golden.numbers(), golden.states(),
                     kBytes * static_cast<double>(golden.numbers()) / kMega));
  answer(golden);
  return golden;
}

/// All present but those for which code is compiled.
Hardest hardestOf(const scene::Scene& scene, const GoldenOptions& options) {
  HardestOptions asked{options.quantities, {}, options.seed};
  for (const WitnessKind& kind : witnessKinds())
    if (kind.info.present && !kind.is_compiled) asked.engines.push_back(kind);
  return hardestStates(scene, asked);
}

constexpr const char* kHardestHead =
    "# What each engine loses at worst\n\n"
    "Decimal digits of the largest entry that are right, the truth being certified: at half of the "
    "states that are drawn, and at the hardest one that a seeded search found; and what the limits "
    "leave there to a program of the usual kinds. The states are golden vectors, in the files "
    "beside. `dynwitness golden SCENE --hardest -o FOLDER` writes all of this again.\n\n"
    "| scene | quantity | engine | usual | worst | limit | state |\n|---|---|---|---|---|---|---|\n";

int run(Arguments arguments) {
  for (const std::string& quantity : arguments.quantities)
    arguments.options.quantities.push_back(quantityNamed(quantity));
  const std::vector<Format> formats = formatsOf(arguments);
  const Admitted admitted = admitAll(arguments);
  if (arguments.hardest && arguments.output.empty())
    refuse("--hardest on standard output, allowed: a folder (-o)");
  if (arguments.output.empty()) {
    if (admitted.scenes.size() > 1 || formats.size() > 1)
      refuse("several scenes or formats on standard output, allowed: one, or a folder (-o)");
    std::optional<Progress> progress(std::in_place,
                                     "golden vectors of " + admitted.scenes.front().name);
    const Golden golden =
        made(admitted.scenes.front(), arguments.options, admitted.left_out.front());
    const std::string text = formats.front().write(golden, DYNWITNESS_VERSION);
    progress.reset();
    fmt::print("{}", text);
    return 0;
  }
  const fs::path folder = arguments.output;
  requireWritableFolder(folder);
  std::vector<std::pair<std::string, std::string>> verifiers;  // read before the long work
  for (const char* file : kVerifiers)
    verifiers.emplace_back(
        file, scene::readTextFile(scene::dataFolder() / "golden" / file, "a verifier"));
  Json scenes = Json::object();
  std::string table = kHardestHead;
  {
    Progress progress(static_cast<int>(admitted.scenes.size()));
    for (std::size_t k = 0; k < admitted.scenes.size(); ++k) {
      const scene::Scene& scene = admitted.scenes[k];
      progress.stage(scene.name);
      Golden golden;
      if (arguments.hardest) {
        Hardest hardest = hardestOf(scene, arguments.options);
        table += hardestTable(hardest);
        golden = std::move(hardest.golden);
      } else {
        golden = made(scene, arguments.options, admitted.left_out[k]);
      }
      Json files = Json::array();
      fs::create_directories(folder);
      for (const Format& format : formats) {
        files.push_back(safeName(scene.name) + format.ending);
        writeWholeFile(folder / files.back().get<std::string>(),
                       format.write(golden, DYNWITNESS_VERSION));
      }
      scenes[scene.name] = {{"files", files},
                            {"states", golden.states()},
                            {"numbers", golden.numbers()},
                            {"left_out", golden.left_out}};
    }
  }
  for (const auto& [file, text] : verifiers) writeWholeFile(folder / file, text);
  if (arguments.hardest) writeWholeFile(folder / "hardest.md", table);
  const Json index = {{"dynwitness", DYNWITNESS_VERSION},
                      {"seed", arguments.options.seed},
                      {"verifiers", kVerifiers},
                      {"scenes", scenes},
                      {"refused", admitted.refused}};
  writeWholeFile(folder / "index.json",
                 index.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  return 0;
}

}  // namespace

Run addGolden(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  CLI::Option* scenes = command->add_option("scene", arguments->scenes, "Scenes");
  for (CLI::Option* change : addChanges(*command, arguments->given)) change->needs(scenes);
  command->add_flag("--all-scenes", arguments->all,
                    "All bundled scenes; those that cannot be told are named");
  command->add_flag(
      "--hardest", arguments->hardest,
      "For each engine and quantity (M, c, g, tau, qdd, or those of --quantity) the state at "
      "which a seeded search found the fewest digits, and a table of what each loses");
  std::vector<std::string> quantities, formats;
  for (const Quantity quantity : kGoldenQuantities) quantities.push_back(name(quantity));
  for (const Format& format : kFormats) formats.push_back(format.name);
  command
      ->add_option(
          "--quantity", arguments->quantities,
          "Quantities: several with commas; without: all, of more than 64 rates all but M, kinetic, qdd, reactions")
      ->delimiter(',')
      ->check(oneOf(quantities));
  addRandom(*command, arguments->options.states, 1000, "at most, of a group");
  addSeed(*command, arguments->options.seed, "of the states");
  command
      ->add_option(
          "--format", arguments->formats,
          "How it is written: several with commas; without: json on standard output, all in a folder")
      ->delimiter(',')
      ->check(oneOf(formats));
  addOutput(*command, arguments->output,
            "folder for SCENE.json, .csv and .h, index.json, and verifiers");
  command->footer(
      "Examples:\n"
      "  dynwitness golden puma_560 -o golden\n"
      "Then in that folder, with answers in lines state,quantity,row,column,value:\n"
      "  python3 verify.py puma_560.csv answers.csv\n"
      "or node verify.mjs, or verify.cpp compiled: no other files are needed. The same seed gives the "
      "same bytes. As one file that has the same bytes, too:\n"
      "  tar --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner \\\n"
      "    -cf golden.tar golden");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
