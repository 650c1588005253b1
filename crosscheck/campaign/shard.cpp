// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/shard.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/system/environment.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/error.hpp"

namespace dynwitness::crosscheck {
namespace fs = std::filesystem;
namespace {

/// Cases that a copy of this process runs: a fork is 1 % of their time, and what a KILL costs is
/// that much work.
constexpr long kBlock = 20;
/// Copies that are planned at a time: so many numbers are held.
constexpr long kBlocksAtATime = 512;
constexpr double kSettled = 5;  ///< [s], after which the disk is asked for

/// What stands in the folder must be of this campaign, before anything is written there.
void requireSameCampaign(const fs::path& folder, const LedgerHead& head) {
  if (!fs::is_directory(folder)) return;
  for (const fs::path& file : ledgersIn(folder)) {
    const std::optional<LedgerHead> found = headOf(file);
    if (found && (found->plan != head.plan || found->version != head.version))
      throw scene::InputError(
          {file.string(), 0},
          fmt::format("is of another campaign: read version {}, plan '{}'; allowed: version {}, "
                      "plan '{}'; or another folder",
                      found->version, found->plan, head.version, head.plan));
  }
}

/// By case: whether some ledger of the folder has it.
std::vector<bool> casesIn(const fs::path& folder, const LedgerHead& head) {
  std::vector<bool> has(static_cast<std::size_t>(head.cases), false);
  for (const fs::path& file : ledgersIn(folder)) {
    std::vector<long> cases;
    const ShardLedger ledger = readShardLedger(
        file, 0,
        [&](const LedgerEntry& entry, std::string_view) { cases.push_back(entry.number); });
    if (!ledger.has_head) continue;
    for (const long number : cases)
      if (number >= 0 && number < head.cases) has[static_cast<std::size_t>(number)] = true;
  }
  return has;
}

/// Puts down what copies have found.
class Writer {
 public:
  Writer(GrowingLedger* ledger, ShardDone* shard, long all,
         const std::function<void(long, long)>& done)
      : ledger_(ledger), shard_(shard), all_(all), done_(done) {}

  void add(const std::string& lines) {
    ledger_->add(lines);
    for (std::size_t begin = 0; begin < lines.size();) {
      const std::size_t end = lines.find('\n', begin);
      SealedLine parts;
      opened(std::string_view(lines).substr(begin, end - begin), &parts);
      const auto verdict = nlohmann::json::parse(parts.record).at("verdict").get<std::string>();
      shard_->wrong += isRight(verdict) ? 0 : 1;
      ++shard_->now;
      begin = end + 1;
    }
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - settled_).count() > kSettled) {
      ledger_->settle();
      settled_ = now;
    }
    if (done_) done_(shard_->before + shard_->now, all_);
  }

 private:
  GrowingLedger* ledger_;
  ShardDone* shard_;
  long all_;
  const std::function<void(long, long)>& done_;
  std::chrono::steady_clock::time_point settled_ = std::chrono::steady_clock::now();
};

/// Runs these cases, so many a copy. @return those whose copies ended without an answer
std::vector<std::pair<long, std::string>> runInCopies(const CaseRunner& runner,
                                                      const std::vector<long>& cases, long block,
                                                      int processes, Writer* writer) {
  std::vector<std::pair<long, std::string>> lost;
  const auto size = static_cast<long>(cases.size());
  inOwnCopies(
      processes, static_cast<int>((size + block - 1) / block),
      runner.plan().seconds * static_cast<double>(block),
      [&](int k) {
        std::string lines;
        for (long i = k * block; i < std::min(size, (k + 1) * block); ++i)
          lines += runner.line(cases[static_cast<std::size_t>(i)]);
        return lines;
      },
      [&](int k, const CopyEnded& ended) {
        if (ended.problem.empty()) {
          writer->add(ended.answer);
          return;
        }
        for (long i = k * block; i < std::min(size, (k + 1) * block); ++i)
          lost.emplace_back(cases[static_cast<std::size_t>(i)], ended.problem);
      });
  return lost;
}

}  // namespace

std::string campaignVersion() {
  const Environment environment = thisEnvironment({}, "not asked");
  return environment.commit.empty()
             ? environment.version
             : fmt::format("{} ({})", environment.version, environment.commit);
}

ShardDone runShard(const CaseRunner& runner, const ShardOptions& options,
                   const std::function<void(long, long)>& done) {
  const LedgerHead head{campaignVersion(), runner.plan().text, runner.plan().cases(), options.shard,
                        options.shards};
  requireSameCampaign(options.folder, head);
  GrowingLedger ledger(options.folder, head);
  const std::vector<bool> has = casesIn(options.folder, head);
  ShardDone out;
  const long all = head.casesOfShard();
  for (long k = options.shard - 1; k < head.cases; k += options.shards)
    out.before += has[static_cast<std::size_t>(k)] ? 1 : 0;
  witnessKinds();  // engines are loaded once, and not by every copy
  Writer writer(&ledger, &out, all, done);
  std::vector<long> next;
  const auto run = [&] {
    // what took a whole copy with it is run again alone, to know which it was
    std::vector<long> again;
    for (const auto& [number, problem] :
         runInCopies(runner, next, kBlock, options.processes, &writer))
      again.push_back(number);
    for (const auto& [number, problem] : runInCopies(runner, again, 1, options.processes, &writer))
      writer.add(runner.lineOfFailed(number, problem, 0));
    next.clear();
  };
  for (long k = options.shard - 1; k < head.cases; k += options.shards) {
    if (has[static_cast<std::size_t>(k)]) continue;
    next.push_back(k);
    if (static_cast<long>(next.size()) == kBlock * kBlocksAtATime) run();
  }
  run();
  ledger.settle();
  return out;
}

}  // namespace dynwitness::crosscheck
