// SPDX-License-Identifier: GPL-3.0-or-later
// A part of a campaign: every shards-th case, written down as they are done.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "crosscheck/campaign/case_runner.hpp"
#include "crosscheck/campaign/shard_ledger.hpp"

namespace dynwitness::crosscheck {

struct ShardOptions {
  int shard = 1, shards = 1;  ///< cases shard - 1, shard - 1 + shards, ...
  std::filesystem::path folder;
  int processes = 1;
};

struct ShardDone {
  long before = 0;  ///< cases of the shard that a ledger of the folder had already
  long now = 0;     ///< that were run
  long wrong = 0;   ///< of those: whose verdict is neither agree nor not answerable
};

/// The version that stands in ledgers: of dynwitness, and the commit of its source.
std::string campaignVersion();

/** Runs the cases of a shard that no ledger of the folder has, and adds them to
    folder/shard-I-of-N.jsonl. It may be ended at any moment, also by KILL: the same call goes on
    where it was. Cases run in copies of this process, some tens each, so that memory does not grow
    with their number; one that crashes or takes longer than the plan allows is written down as
    failed.

    @param done  called with the number of cases that are done, before and now, and that of the
    shard
    @throws scene::InputError   the folder cannot be written to or is of another campaign, or the
                                shard is being done by another process
    @throws std::runtime_error  the disk is full: what is written stays */
ShardDone runShard(const CaseRunner& runner, const ShardOptions& options,
                   const std::function<void(long done, long all)>& done = {});

}  // namespace dynwitness::crosscheck
