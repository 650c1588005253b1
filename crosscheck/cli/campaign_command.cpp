// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness campaign: the cases of a plan, on any number of machines, and what they come to.
#include <algorithm>
#include <charconv>
#include <memory>
#include <tuple>

#include <fmt/format.h>

#include "crosscheck/campaign/merge.hpp"
#include "crosscheck/campaign/queue.hpp"
#include "crosscheck/campaign/shard.hpp"
#include "crosscheck/cli/commands.hpp"
#include "crosscheck/cli/options.hpp"
#include "crosscheck/cli/progress.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/own_program.hpp"
#include "crosscheck/system/processes.hpp"
#include "scene/error.hpp"

namespace dynwitness::cli {
namespace {

namespace fs = std::filesystem;
using namespace crosscheck;

struct Arguments {
  std::vector<std::string> words;
  std::string shard, on, output = "campaign";
  int shards = 0;
  int processes = availableProcessors();
};

/// "3/8"
std::pair<int, int> shardOf(const std::string& text) {
  int shard = 0, shards = 0;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, shard);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == '/') {
    const auto second = std::from_chars(first.ptr + 1, end, shards);
    if (second.ec == std::errc() && second.ptr == end && shard >= 1 && shard <= shards &&
        shards <= 1000000)
      return {shard, shards};
  }
  throw scene::InputError({}, fmt::format("--shard: read '{}', allowed: I/N with 1 <= I <= N <= "
                                          "1000000, such as 3/8",
                                          text));
}

/// The front of all commands, beside this program.
fs::path frontProgram() {
  return ownProgram().parent_path() / "dynwitness";
}

std::vector<fs::path> foldersOf(const Arguments& arguments) {
  const std::vector<fs::path> folders(arguments.words.begin() + 1, arguments.words.end());
  if (folders.empty())
    throw scene::InputError({}, fmt::format("campaign {}: no folder, allowed: one or more, each "
                                            "with the shards that `campaign PLAN -o FOLDER` wrote",
                                            arguments.words.front()));
  return folders;
}

void forbid(const std::string& option, bool is_given, const std::string& with) {
  if (is_given)
    throw scene::InputError({}, fmt::format("campaign {}: {} is of campaign PLAN", with, option));
}

/// What is left, in the time of one core.
std::string remaining(const GatheredLedgers& gathered) {
  const auto done = static_cast<double>(gathered.entries.size());
  if (done == 0) return "nothing is done yet";
  const double each = gathered.seconds() / done;
  return fmt::format("{:.3g} cases a core and minute; what is missing takes {} of one core",
                     60 / each, duration(each * static_cast<double>(gathered.missing_cases)));
}

int tellStatus(const Arguments& arguments) {
  forbid("--shard", !arguments.shard.empty(), "status");
  const GatheredLedgers gathered = gatherLedgers(foldersOf(arguments));
  for (const ShardLedger& ledger : gathered.ledgers) {
    fmt::print("{}: {} of {} cases, {} of work\n", ledger.file.string(), ledger.entries,
               ledger.head.casesOfShard(), duration(ledger.seconds));
  }
  for (const std::string& one : gathered.left_out) fmt::print("left out: {}\n", one);
  fmt::print("{} of {} cases; {}\n", gathered.entries.size(), gathered.head.cases,
             remaining(gathered));
  return gathered.missing_cases == 0 ? 0 : 1;
}

/// The shards of these folders together, told and written into a folder.
int mergeInto(const fs::path& folder, const std::vector<fs::path>& shards) {
  const GatheredLedgers gathered = gatherLedgers(shards);
  const CampaignSum sum = writeMerged(gathered, folder);
  fmt::print("{}{}: cases.jsonl, campaign.json\n", describeSum(gathered, sum), folder.string());
  return sum.isRight() && gathered.missing_cases == 0 ? 0 : 1;
}

int mergeAll(const Arguments& arguments) {
  forbid("--shard", !arguments.shard.empty(), "merge");
  requireWritableFolder(arguments.output);
  return mergeInto(arguments.output, foldersOf(arguments));
}

/// On other machines.
int runElsewhere(const Arguments& arguments, const CampaignPlan& plan) {
  QueuedCampaign campaign;
  campaign.program = ownProgram();  // the front would be started only to become it
  campaign.plan = fs::absolute(arguments.words.front()).lexically_normal();
  campaign.folder = fs::absolute(arguments.output).lexically_normal();
  campaign.processes = arguments.processes;
  const std::string ssh = "ssh:";
  const bool is_ssh = arguments.on.compare(0, ssh.size(), ssh) == 0;
  const std::vector<std::string> hosts =
      is_ssh ? readHosts(arguments.on.substr(ssh.size())) : std::vector<std::string>();
  campaign.shards =
      static_cast<int>(std::min<long>(plan.cases(), arguments.shards > 0 ? arguments.shards
                                                    : is_ssh ? 4 * static_cast<long>(hosts.size())
                                                             : 8));
  requireWritableFolder(campaign.folder);
  if (arguments.on == "parallel") {
    fmt::print("{}\n", parallelLine(campaign));
    return 0;
  }
  if (arguments.on == "slurm") {
    const SlurmJobs jobs = submitToSlurm(campaign);
    fmt::print("submitted: {} shards as job array {}, then job {} merges into {}\n",
               campaign.shards, jobs.array, jobs.merge, campaign.folder.string());
    return 0;
  }
  {
    Progress progress(plan.title);
    runOverSsh(campaign, hosts,
               [&](const std::string& what) { tell(fmt::format("dynwitness: {}\n", what)); });
  }
  return mergeInto(campaign.folder, {campaign.folder});
}

int runPart(const Arguments& arguments) {
  if (arguments.words.size() > 1)
    throw scene::InputError({}, fmt::format("campaign: read \"{}\" after the plan, allowed: one "
                                            "plan; or merge or status with folders",
                                            arguments.words[1]));
  const CampaignPlan plan = readCampaignPlan(arguments.words.front());
  if (!arguments.on.empty()) return runElsewhere(arguments, plan);
  ShardOptions options;
  if (!arguments.shard.empty()) std::tie(options.shard, options.shards) = shardOf(arguments.shard);
  options.folder = arguments.output;
  options.processes = arguments.processes;
  const CaseRunner runner(plan, frontProgram());
  if (options.shards > runner.plan().cases())
    throw scene::InputError({}, fmt::format("--shard: {} shards of {} cases, allowed: as many as "
                                            "there are cases",
                                            options.shards, runner.plan().cases()));
  ShardDone done;
  {
    Progress progress(runner.plan().title);
    scene::Work work("cases", static_cast<double>(runner.plan().cases()));
    done = runShard(runner, options, [&](long cases, long all) {
      work.doneTo(static_cast<double>(cases) / static_cast<double>(all));
      progress.note(fmt::format("{} of {} cases", cases, all));
    });
  }
  fmt::print("shard {}/{} of {}: {} cases were there, {} are new, {} of them wrong\n",
             options.shard, options.shards, runner.plan().title, done.before, done.now, done.wrong);
  if (options.shards > 1) return done.wrong == 0 ? 0 : 1;
  return mergeInto(options.folder, {options.folder});
}

int run(const Arguments& arguments) {
  const std::string& first = arguments.words.front();
  if (first == "merge") return mergeAll(arguments);
  if (first == "status") return tellStatus(arguments);
  return runPart(arguments);
}

}  // namespace

Run addCampaign(CLI::App* command) {
  auto arguments = std::make_shared<Arguments>();
  command
      ->add_option("plan", arguments->words,
                   "A plan in TOML, to be run; or merge FOLDER..., or status FOLDER...")
      ->required();
  command->add_option("--shard", arguments->shard,
                      "I/N: only cases I, I + N, I + 2 N, ... of the plan, counted from 1");
  CLI::Option* shard = command->get_option("--shard");
  command
      ->add_option("--on", arguments->on,
                   "On other machines that see the same folders: slurm submits a job array and the "
                   "merging; ssh:FILE runs shards on the hosts of a file, one a line; parallel "
                   "prints a line for GNU parallel")
      ->excludes(shard)
      ->check(CLI::Validator(
          [](std::string& text) {
            return text == "slurm" || text == "parallel" ||
                           (text.compare(0, 4, "ssh:") == 0 && text.size() > 4)
                       ? std::string()
                       : fmt::format("read '{}', allowed: slurm, ssh:FILE, parallel", text);
          },
          "slurm,ssh:FILE,parallel"));
  command
      ->add_option("--shards", arguments->shards,
                   "With --on: into how many; 8 where nothing is said, for ssh 4 a host")
      ->check(whole(1, 1000000))
      ->needs(command->get_option("--on"));
  addOutput(*command, arguments->output, "folder of the shards, or of what merge writes")
      ->capture_default_str();
  addProcesses(*command, arguments->processes);
  command->footer(
      "Examples:\n"
      "  dynwitness campaign nightly.toml -o nights\n"
      "  dynwitness campaign nightly.toml --shard 3/8 -o nights\n"
      "  dynwitness campaign status nights\n"
      "  dynwitness campaign merge nights -o result\n"
      "  dynwitness campaign nightly.toml --on slurm --shards 200 -o nights\n"
      "A plan says which cases are tried: random mechanisms, scenes by states, other commands\n"
      "(data/campaigns/README.md). Each case is written down when it is done; the command may be\n"
      "killed at any moment, and the same words go on from there. Shards need nothing of each other.\n"
      "Exit status: 0 all is done and agrees; 1 something disagrees, or is missing.");
  return [arguments] { return run(*arguments); };
}

}  // namespace dynwitness::cli
