// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness crosscheck: the main job.
#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/chart/chart.hpp"
#include "crosscheck/cli/campaign.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/crosscheck_tables.hpp"
#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/engine_options.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/conductor/campaign.hpp"
#include "crosscheck/conductor/crosscheck.hpp"
#include "crosscheck/conductor/plan.hpp"
#include "crosscheck/inputs/feature_pairs.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/inputs/random_mechanism.hpp"
#include "crosscheck/kernel/compiled.hpp"
#include "crosscheck/kernel/kernel.hpp"
#include "crosscheck/report/atlas_glance.hpp"
#include "crosscheck/report/json.hpp"
#include "crosscheck/report/model_pictures.hpp"
#include "crosscheck/report/pairs.hpp"
#include "crosscheck/report/plot.hpp"
#include "crosscheck/report/report.hpp"
#include "crosscheck/report/show.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/gnuplot.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/system/shell.hpp"
#include "crosscheck/verdicts/check_reading.hpp"
#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/tables.hpp"
#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

constexpr const char *kAsWritten = "as-written", *kRandom = "random";

struct CrosscheckArguments {
  std::vector<std::string> scenes;
  GivenScene given;  ///< without a name
  std::string report = "report", json, bench, stability;
  std::vector<std::string> reductions;
  Options options;
  std::string parameters = kAsWritten;
  std::vector<std::string> engines;  ///< commands
  Limits limits;                     ///< of each of these programs
  int mechanisms = 0, joints = 12;   ///< random mechanisms instead of scenes
  bool pairs = false;                ///< those that have every pair of features
  bool states_given = false, joints_given = false;
  int processes = availableProcessors();
  bool charts = true;
};

/// Slow methods would make a report wait; `dynwitness chart` takes more.
constexpr int kMostChartStates = 100;

/// The scenes asked for, or all that are bundled with those of the tables.
std::vector<scene::Scene> scenesOf(const CrosscheckArguments& arguments) {
  std::vector<scene::Scene> scenes;
  for (const std::string& name : arguments.scenes) {
    GivenScene given = arguments.given;
    given.name = name;
    // joints that move no inertia: what needs no inverse of M is compared all the same
    scenes.push_back(readScene(given, scene::InertiaNeed::kOfNoJoint));
    for (const std::string& what : scenes.back().not_modelled)
      tell(fmt::format("{}: {}\n", scenes.back().name, what));
  }
  if (!arguments.scenes.empty()) return scenes;
  for (const auto& file : scene::bundledScenes()) scenes.push_back(scene::readScene(file));
  for (const auto& table : bundledTables())
    if (const auto file = ownScene(table); !file.empty()) scenes.push_back(scene::readScene(file));
  return scenes;
}

/// The words that give this result again.
std::string reproduce(const CrosscheckArguments& arguments) {
  std::string command = "dynwitness crosscheck";
  for (const std::string& name : arguments.scenes) command += fmt::format(" '{}'", name);
  const GivenScene& given = arguments.given;
  for (const auto& [option, value] : {std::pair("--gravity", given.changes.gravity),
                                      {"--base", given.changes.base},
                                      {"--root", given.root}})
    if (!value.empty()) command += fmt::format(" {} {}", option, shellWord(value));
  for (const std::string& word : given.changes.sets) command += " --set " + shellWord(word);
  command +=
      fmt::format(" --random {} --seed {}", arguments.options.states, arguments.options.seed);
  for (const std::string& name : arguments.options.witnesses) command += " --witness " + name;
  for (const std::string& engine : arguments.engines) command += " --engine " + shellWord(engine);
  if (!arguments.engines.empty() && arguments.limits.seconds != Limits().seconds)
    command += fmt::format(" --engine-seconds {}", arguments.limits.seconds);
  if (!arguments.engines.empty() && arguments.limits.gigabytes != Limits().gigabytes)
    command += fmt::format(" --engine-memory {}", arguments.limits.gigabytes);
  if (arguments.options.error_probability != Options().error_probability)
    command += fmt::format(" --error-probability {}", arguments.options.error_probability);
  if (arguments.parameters != kAsWritten) command += " --parameters " + arguments.parameters;
  if (!arguments.options.drift) command += " --no-drift";
  if (!arguments.charts) command += " --no-charts";
  if (!arguments.bench.empty()) command += fmt::format(" --bench '{}'", arguments.bench);
  if (!arguments.stability.empty())
    command += fmt::format(" --stability '{}'", arguments.stability);
  for (const std::string& file : arguments.reductions)
    command += fmt::format(" --reduction '{}'", file);
  return command;
}

/// On each card, whose words the witness computes from.
void sayWhatIsRead(std::vector<WitnessInfo>& witnesses) {
  for (WitnessInfo& witness : witnesses) {
    if (!witness.convention("reads").empty() || witness.name == "table") continue;
    const std::string line = "reads: the scene, as dynwitness has read it from the file";
    witness.conventions = line + (witness.conventions.empty() ? "" : "\n" + witness.conventions);
  }
}

/// Witnesses that the options name, or all that are present but kernels, whose making is slow.
CampaignOptions campaignOptions(const CrosscheckArguments& arguments) {
  CampaignOptions options;
  options.exact.seed = arguments.options.seed;
  options.exact.error_probability = arguments.options.error_probability;
  if (arguments.states_given) options.states = arguments.options.states;
  for (const WitnessKind& kind : selectWitnesses(arguments.options.witnesses)) {
    const bool named = !arguments.options.witnesses.empty();
    if (named) options.exact.witnesses.push_back(kind);
    if (named || !kind.is_compiled) options.in_double.push_back(kind);
  }
  return options;
}

/// --mechanisms, --pairs: mechanisms instead of scenes, and no report.
int runRandom(const CrosscheckArguments& arguments) {
  if (!arguments.scenes.empty())
    throw scene::InputError({}, fmt::format("{} draws its own mechanisms: leave the scenes out",
                                            arguments.pairs ? "--pairs" : "--mechanisms"));
  requireWritableFile(arguments.json);
  const CampaignOptions options = campaignOptions(arguments);
  // the rarest pairs are in a few of so many; what none has is MISSING
  constexpr int kPool = 3000;
  std::vector<int> indices;
  PairTable pairs;
  if (arguments.pairs) {
    indices = randomMechanismsOfPairs(options.exact.seed, arguments.joints, kPool);
    for (const int index : indices)
      pairs.add(randomWholeScene(options.exact.seed, static_cast<std::uint64_t>(index),
                                 arguments.joints));
  }
  const std::vector<PairTable::Pair> missing =
      arguments.pairs ? pairs.missing() : std::vector<PairTable::Pair>();
  RandomCampaign campaign;
  {
    CampaignProgress progress(arguments.pairs ? pairs.mechanisms() : arguments.mechanisms);
    const auto show = [&](int done) { progress.show(done); };
    campaign = arguments.pairs ? crosscheckRandomOf(indices, arguments.joints, options,
                                                    arguments.processes, show)
                               : crosscheckRandom(arguments.mechanisms, arguments.joints, options,
                                                  arguments.processes, show);
  }
  if (!arguments.json.empty())
    writeWholeFile(arguments.json,
                   campaignJson(campaign, options, arguments.joints,
                                arguments.pairs ? pairsJson(pairs) : std::string()));
  printCampaign(campaign, options);
  if (arguments.pairs) {
    fmt::print("pairs of features, in {} of the first {} random mechanisms:\n", pairs.mechanisms(),
               kPool);
    for (const PairRelation relation : kAllPairRelations)
      fmt::print("  {}: {} of {}\n", name(relation), pairs.covered(relation),
                 pairs.wanted(relation));
    for (const PairTable::Pair& pair : missing)
      fmt::print("MISSING {}: {}; {}\n", name(pair.relation), pair.row, pair.column);
  }
  return campaign.failures.empty() && missing.empty() ? 0 : 1;
}

/// Two witnesses are missed without a compiler, or a folder for what it makes: the reason is told.
void tellMissingKernels() {
  try {
    kernel::requireCompiler();
  } catch (const kernel::CannotCompile& error) {
    tell(fmt::format("dynwitness: kernels are left out: {}\n", error.what()));
  }
}

/// What a run will do and about how long it takes, where that is longer than one likes to wait.
void tellPlan(const std::vector<scene::Scene>& scenes, std::size_t witnesses,
              const CrosscheckArguments& arguments) {
  constexpr double kWorthTelling_s = 5;
  double seconds = 0;
  for (const scene::Scene& scene : scenes) {
    const Plan plan = planFor(scene, arguments.options);
    for (const std::string& told : plan.told) tell(fmt::format("{}: {}\n", scene.name, told));
    seconds += expectedSeconds(scene, plan);
  }
  const int processes = std::min(arguments.processes, static_cast<int>(scenes.size()));
  if (seconds / processes < kWorthTelling_s) return;
  tell(
      fmt::format("crosscheck of {} scene{} at {} states by {} witnesses, {} process{}: about {}\n",
                  scenes.size(), scenes.size() == 1 ? "" : "s", arguments.options.states, witnesses,
                  processes, processes == 1 ? "" : "es", duration(seconds / processes)));
}

/// Pictures that move, a page a scene; those of many links would be slow.
std::vector<std::string> viewsOf(const std::vector<scene::Scene>& scenes) {
  constexpr std::size_t kMostLinks = 500;
  std::vector<std::string> pages;
  for (const scene::Scene& scene : scenes)
    pages.push_back(scene.mechanism.links.size() <= kMostLinks
                        ? showPage({scene}, viewOf(scene), DYNWITNESS_VERSION)
                        : "");
  return pages;
}

int runCrosscheck(const CrosscheckArguments& arguments) {
  tellMissingKernels();
  if (arguments.mechanisms > 0 || arguments.pairs) return runRandom(arguments);
  if (arguments.joints_given)
    throw scene::InputError(
        {}, "--most-joints without --mechanisms or --pairs, allowed: with one of them");
  const std::vector<WitnessKind> kinds = selectWitnesses(arguments.options.witnesses);
  const std::vector<scene::Scene> scenes = scenesOf(arguments);
  for (const scene::Scene& scene : scenes) {
    requireMotion(scene);
    admit(scene, {Command::kCrosscheck});
  }
  const std::vector<WitnessKind> engines =
      engineKinds(arguments.engines, arguments.limits, scenes.front());
  std::vector<WitnessKind> all_kinds = kinds;
  all_kinds.insert(all_kinds.end(), engines.begin(), engines.end());
  tellPlan(scenes, all_kinds.size(), arguments);
  std::optional<BenchResult> bench;
  if (!arguments.bench.empty()) bench = readBench(arguments.bench);
  const std::string atlas =
      arguments.stability.empty() ? std::string() : atlasSection(arguments.stability);
  std::vector<std::string> names;
  for (const scene::Scene& scene : scenes) names.push_back(scene.name);
  const std::map<std::string, std::string> models = modelSections(arguments.reductions, names);
  requireWritable(arguments.report);
  // the report's own folder may have to be made first, which is done by then
  if (const std::filesystem::path json = arguments.json;
      std::filesystem::weakly_canonical(json.parent_path()) !=
      std::filesystem::weakly_canonical(arguments.report))
    requireWritableFile(json);

  const std::function<std::string()> gnuplot = askGnuplotVersion();
  CrosscheckResult result;
  result.seed = arguments.options.seed;
  result.states = arguments.options.states;
  result.command = reproduce(arguments);
  std::vector<Environment::Library> libraries;
  // of witnesses that somebody chose none is missing
  for (const WitnessKind& kind : arguments.options.witnesses.empty() ? witnessKinds() : kinds) {
    result.witnesses.push_back(kind.info);
    if (kind.info.version != DYNWITNESS_VERSION)
      libraries.push_back({kind.info.name, kind.info.present ? kind.info.version : "absent"});
  }
  for (const WitnessKind& kind : engines) {
    result.witnesses.push_back(kind.info);
    libraries.push_back({kind.info.name, kind.info.version});
  }
  result.witnesses.push_back({"table", DYNWITNESS_VERSION, "published numbers in data/reference"});
  result.witnesses.push_back(rereadingInfo(DYNWITNESS_VERSION));
  sayWhatIsRead(result.witnesses);
  std::vector<Chart> charts;
  {
    const int count = static_cast<int>(scenes.size());
    Progress progress(count + (arguments.charts ? 2 : 1), 0, false);
    scene::Work work("", 1.25 * count);  // the charts are the last fifth
    result.scenes = crosscheckScenes(scenes, all_kinds, arguments.options, arguments.processes,
                                     [&](int i) { progress.stage(scenes[i].name); });
    if (arguments.charts) progress.stage("charts");  // timed alone on the machine, one by one
    scene::Work charts_work("charts", count, 0.25 * count);
    for (int i = 0; i < count && arguments.charts; ++i, charts_work.done())
      charts.push_back(refusals(scenes[i], Command::kChart).empty()
                           ? speedAccuracy(scenes[i], Quantity::kTau, kinds,
                                           std::min(arguments.options.states, kMostChartStates),
                                           arguments.options.seed)
                           : Chart());  // not drawn
    progress.stage("report");
    const Environment environment = thisEnvironment(libraries, gnuplot());
    // of scenes that somebody chose nothing is missing
    PairTable pairs;
    for (const scene::Scene& scene : scenes) pairs.add(scene);
    const bool all = arguments.scenes.empty();
    writeReport(result, environment, arguments.report, charts, bench ? &*bench : nullptr,
                viewsOf(scenes), all ? &pairs : nullptr, atlas, models);
    if (!arguments.json.empty())
      writeWholeFile(arguments.json,
                     reportJson(result, environment, bench ? benchJson(*bench) : std::string(),
                                all ? pairsJson(pairs) : std::string()));
  }
  std::map<std::string, std::string> asked;  // how `check` asks a program, by witness
  for (std::size_t k = 0; k < engines.size(); ++k)
    asked[engines[k].info.name] = "--engine " + shellWord(arguments.engines.at(k));
  const std::string page = (std::filesystem::path(arguments.report) / "index.html").string();
  printResult(result, page, asked);
  fmt::print("report: {}\n", page);
  const RunVerdict verdict = result.verdict();
  if (verdict == RunVerdict::kNotAnswerable)
    throw std::runtime_error("no check could be answered; the report says why");
  if (verdict == RunVerdict::kProvesNothing)
    throw std::runtime_error("the run proves nothing: " + result.controlLine());
  return exitStatus(verdict);
}

}  // namespace

Run addCrosscheck(CLI::App* command) {
  auto arguments = std::make_shared<CrosscheckArguments>();
  command->footer(
      "Examples:\n"
      "  dynwitness crosscheck \"double pendulum\"\n"
      "  dynwitness crosscheck my_arm.urdf puma_560 -o report\n"
      "  dynwitness crosscheck simple_pendulum --engine \"python3 my_arm.py\"\n"
      "  dynwitness crosscheck --mechanisms 1000\n"
      "Exit status: 0 what can be compared was, and agrees; 1 a disagreement, or more than a "
      "tenth of the\n"
      "comparisons of a quantity of a scene is missing, or its start leaves closures open "
      "(\"incomplete\");\n"
      "2 bad usage or input; 3 a failure of dynwitness itself, among them that its own control, "
      "a known\n"
      "fault, was not found (\"proves nothing\").\n"
      "\n"
      "A comparison is one check at one state, and every one ought to be possible but: those of a "
      "witness that\n"
      "cannot hold the scene at all; those of a quantity that does not exist there (M is "
      "singular, certified; a\n"
      "law that the mechanism has no parts for); energy where nothing moves or the steps do not "
      "resolve the\n"
      "motion. An error bound that runs away or a witness that fails at a state is held against "
      "the run.");
  CLI::Option* scenes =
      command->add_option("scene", arguments->scenes, "Scenes; without any: all bundled ones");
  for (CLI::Option* change : addChanges(*command, arguments->given)) change->needs(scenes);
  addOutput(*command, arguments->report, "folder of the report")->capture_default_str();
  addJson(*command, arguments->json, "report.json, that is; with --mechanisms or --pairs theirs");
  command->add_option("--bench", arguments->bench,
                      "Show speed as well: a bench.json that `./dynwitness bench` wrote");
  command->add_option(
      "--stability", arguments->stability,
      "Show where methods fail as well: a stability.json that `dynwitness stability` "
      "wrote");
  command
      ->add_option("--reduction", arguments->reductions,
                   "Show on a scene's page how little model it needs: JSON that `dynwitness reduce "
                   "--front` or `dynwitness need` wrote of it; again for more")
      ->allow_extra_args(false);
  command
      ->add_option("--witness", arguments->options.witnesses,
                   "Witnesses: only these are compared; laws of mechanics are tested on our sweeps "
                   "whoever is named")
      ->delimiter(',');
  CLI::Option* engine = addEngineOptions(*command, arguments->engines, arguments->limits);
  engine->description(engine->get_description() + "; several times for several");
  const CLI::Option* states = addRandom(
      *command, arguments->options.states, 1000000,
      "for each check. Of more than 64 joints or links fewer are taken where this is not given, of "
      "more than 128 joints witnesses alone are compared, and both are told");
  addSeed(*command, arguments->options.seed, "of the states");
  command
      ->add_option("--error-probability", arguments->options.error_probability,
                   "Chance at most that an exact check passes a wrong formula")
      ->capture_default_str()
      ->check(between(1e-300, 0.5));
  command
      ->add_option(
          "--parameters", arguments->parameters,
          "Parameters: in exact checks the scene's values, or random elements of the field, so "
          "that the verdict covers every robot with that structure")
      ->capture_default_str()
      ->check(oneOf({kAsWritten, kRandom}));
  command
      ->add_option(
          "--mechanisms", arguments->mechanisms,
          "Check this many random mechanisms, exactly and with all witnesses in double at 3 states "
          "each (or --random), instead of scenes; no report. Kernels take part when --witness "
          "names them")
      ->excludes("--parameters", "--bench", "--stability", "--reduction", "--engine")
      ->check(whole(1, 100000000));
  command
      ->add_flag(
          "--pairs", arguments->pairs,
          "The same about those random mechanisms that have, between them, every pair of "
          "features (joint kinds inboard and outboard, rotors, springs, turned frames, ...); "
          "exit status 1 if a pair is missing")
      ->excludes("--mechanisms", "--parameters", "--bench", "--stability", "--reduction",
                 "--engine");
  const CLI::Option* joints =
      command->add_option("--most-joints", arguments->joints, "Most joints of a random mechanism")
          ->capture_default_str()
          ->check(whole(1, 1000));
  addProcesses(*command, arguments->processes);
  command->add_flag("!--no-drift", arguments->options.drift,
                    "Leave out the 10 s simulations and the published motions");
  command->add_flag("!--no-charts", arguments->charts,
                    "Leave out the charts of speed against accuracy, the only part that a clock "
                    "measures");
  return [arguments, states, joints] {
    arguments->states_given = states->count() > 0;
    if (arguments->states_given && arguments->scenes.empty() && arguments->mechanisms == 0 &&
        !arguments->pairs)
      tell(
          "dynwitness crosscheck: all bundled scenes, at as many states as --random says; random "
          "mechanisms, so called until 0.1.0, are --mechanisms now\n");
    arguments->joints_given = joints->count() > 0;
    if (arguments->parameters == kRandom) arguments->options.parameters = Parameters::kRandom;
    return runCrosscheck(*arguments);
  };
}

}  // namespace dynwitness::cli
