// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/queue.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/system/children.hpp"
#include "crosscheck/system/files.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/system/shell.hpp"
#include "scene/error.hpp"
#include "scene/text_file.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

using scene::InputError;

constexpr double kLongest = 30 * 24 * 3600;  ///< [s], for a shard on another host

std::vector<std::string> wordsOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::string submitted(const std::vector<std::string>& words) {
  Child child(words);
  const Ending ending = child.wait();
  if (ending.not_found)
    throw InputError({},
                     "--on slurm: there is no sbatch here, allowed: a machine that submits to "
                     "Slurm; --on ssh:HOSTS and --on parallel need none");
  if (!ending.problem.empty()) throw std::runtime_error("sbatch: " + ending.problem);
  const std::string number = ending.output.substr(0, ending.output.find_first_of(";\n"));
  if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos)
    throw std::runtime_error(
        fmt::format("sbatch: read '{}' instead of a job's number", ending.output));
  return number;
}

/// Runs a shard on a host. @return why it is not done there; empty: it is
std::string runOn(const std::string& host, const QueuedCampaign& campaign, int shard) {
  const char* const other = std::getenv("DYNWITNESS_SSH");
  std::vector<std::string> words = wordsOf(other ? other : "ssh");
  if (words.empty()) words = {"ssh"};
  for (const char* word : {"-o", "BatchMode=yes", "-o", "ConnectTimeout=15", "-o",
                           "ServerAliveInterval=15", "-o", "ServerAliveCountMax=4"})
    words.emplace_back(word);
  words.push_back(host);
  // 1 says that something disagrees, which is written down as well
  words.push_back(campaign.commandOf(std::to_string(shard)) + "; [ $? -le 1 ]");
  ChildOptions options;
  options.seconds = kLongest;
  Child child(words, options);
  return child.wait().problem;
}

/// Every so-many-th of the open shards, from one on.
std::vector<int> partOf(const std::vector<int>& open, int first, std::size_t step) {
  std::vector<int> part;
  for (std::size_t i = static_cast<std::size_t>(first); i < open.size(); i += step)
    part.push_back(open[i]);
  return part;
}

}  // namespace

std::string QueuedCampaign::commandOf(const std::string& shard) const {
  return fmt::format("{} campaign {} --shard {}/{} -o {} --processes {}",
                     shellWord(program.string()), shellWord(plan.string()), shard, shards,
                     shellWord(folder.string()), processes);
}

std::string QueuedCampaign::mergeCommand() const {
  return fmt::format("{0} campaign merge {1} -o {1}", shellWord(program.string()),
                     shellWord(folder.string()));
}

std::string slurmArray(const QueuedCampaign& campaign) {
  return fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --job-name=dynwitness\n"
      "#SBATCH --array=1-{0}\n"
      "#SBATCH --cpus-per-task={1}\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "#SBATCH --output={2}/slurm-%a.log\n"
      "{3}\n"
      "status=$?\n"
      "# 1 says that something disagrees: that is a result, and no failure of the job\n"
      "[ $status -le 1 ] && exit 0\n"
      "[ \"${{SLURM_RESTART_COUNT:-0}}\" -lt 3 ] && scontrol requeue "
      "\"${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}\"\n"
      "exit $status\n",
      campaign.shards, campaign.processes, campaign.folder.string(),
      campaign.commandOf("$SLURM_ARRAY_TASK_ID"));
}

std::string slurmMerge(const QueuedCampaign& campaign) {
  return fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --job-name=dynwitness-merge\n"
      "#SBATCH --requeue\n"
      "#SBATCH --output={0}/merged.log\n"
      "{1}\n",
      campaign.folder.string(), campaign.mergeCommand());
}

SlurmJobs submitToSlurm(const QueuedCampaign& campaign) {
  fs::create_directories(campaign.folder);
  const fs::path array = campaign.folder / "campaign.sbatch",
                 merge = campaign.folder / "merge.sbatch";
  writeWholeFile(array, slurmArray(campaign));
  writeWholeFile(merge, slurmMerge(campaign));
  SlurmJobs jobs;
  jobs.array = submitted({"sbatch", "--parsable", array.string()});
  jobs.merge = submitted({"sbatch", "--parsable",
                          fmt::format("--dependency=afterany:{}", jobs.array), merge.string()});
  return jobs;
}

std::string parallelLine(const QueuedCampaign& campaign) {
  return fmt::format("seq {} | parallel --retries 3 {} && {}", campaign.shards,
                     shellWord(campaign.commandOf("{}") + "; [ $? -le 1 ]"),
                     campaign.mergeCommand());
}

std::vector<std::string> readHosts(const fs::path& file) {
  std::istringstream text(scene::readTextFile(file, "a file of hosts, one a line"));
  std::vector<std::string> hosts;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    const std::vector<std::string> words = wordsOf(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    if (words.size() > 1 || words[0][0] == '-')
      throw InputError({file.string(), number},
                       fmt::format("read '{}', allowed: one host a line, as ssh takes it", line));
    hosts.push_back(words[0]);
  }
  if (hosts.empty()) throw InputError({file.string(), 0}, "names no host");
  return hosts;
}

void runOverSsh(const QueuedCampaign& campaign, const std::vector<std::string>& hosts,
                const std::function<void(const std::string&)>& ended) {
  std::vector<std::string> alive = hosts;
  std::vector<int> open;
  for (int shard = 1; shard <= campaign.shards; ++shard) open.push_back(shard);
  while (!open.empty() && !alive.empty()) {
    const auto count = static_cast<int>(alive.size());
    std::vector<std::string> still_alive;
    std::vector<int> left;
    inOwnCopies(
        count, count, kLongest,
        [&](int k) {  // "3 5 \nwhy these are undone"
          std::string undone, problem;
          for (const int shard : partOf(open, k, alive.size())) {
            if (problem.empty())
              problem = runOn(alive[static_cast<std::size_t>(k)], campaign, shard);
            if (!problem.empty()) undone += fmt::format("{} ", shard);
          }
          return undone + "\n" + problem;
        },
        [&](int k, const CopyEnded& copy) {
          const std::string& host = alive[static_cast<std::size_t>(k)];
          std::string problem = copy.problem;
          if (problem.empty()) {
            const std::size_t end = copy.answer.find('\n');
            problem = copy.answer.substr(end + 1);
            for (const std::string& shard : wordsOf(copy.answer.substr(0, end)))
              left.push_back(std::stoi(shard));
          } else {
            for (const int shard : partOf(open, k, alive.size())) left.push_back(shard);
          }
          if (problem.empty()) still_alive.push_back(host);
          ended(problem.empty() ? fmt::format("{}: done", host)
                                : fmt::format("{}: given up: {}", host, problem));
        });
    std::sort(left.begin(), left.end());
    open = left;
    alive = still_alive;
  }
}

}  // namespace dynwitness::crosscheck
