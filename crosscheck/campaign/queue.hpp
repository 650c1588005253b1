// SPDX-License-Identifier: GPL-3.0-or-later
// Shards on other machines, which see the same folders: by Slurm, by ssh, by GNU parallel.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace dynwitness::crosscheck {

/// What runs a shard.
struct QueuedCampaign {
  std::filesystem::path program;       ///< dynwitness, by its path, there as here
  std::filesystem::path plan, folder;  ///< absolute
  int shards = 1;
  int processes = 1;  ///< of each shard

  /// "'/usr/bin/dynwitness' campaign '/me/nightly.toml' --shard SHARD/8 -o '...' --processes 1"
  /// @param shard  a number, or what a shell makes one of
  std::string commandOf(const std::string& shard) const;
  std::string mergeCommand() const;
};

/// A job array of Slurm, a task a shard, that is queued again when it ends otherwise than by a
/// result.
std::string slurmArray(const QueuedCampaign& campaign);
/// The job that merges when all tasks have ended, however they did.
std::string slurmMerge(const QueuedCampaign& campaign);

struct SlurmJobs {
  std::string array, merge;  ///< their numbers
};
/** Writes both scripts into the folder and submits them by sbatch.
    @throws scene::InputError   there is no sbatch here
    @throws std::runtime_error  what it has said */
SlurmJobs submitToSlurm(const QueuedCampaign& campaign);

/// A line for GNU parallel.
std::string parallelLine(const QueuedCampaign& campaign);

/** Hosts, one a line; what stands behind # is a remark.
    @throws scene::InputError  the file cannot be read, or names none */
std::vector<std::string> readHosts(const std::filesystem::path& file);

/** Runs all shards on these hosts by ssh (the words of DYNWITNESS_SSH in its place), one at a time
    on each. What a host that does not answer, or on which a shard fails, leaves undone goes to the
    others; it gets nothing more. Shards that no host has done are missing when merged.
    @param ended  told when a host has done its part, or is given up and why */
void runOverSsh(const QueuedCampaign& campaign, const std::vector<std::string>& hosts,
                const std::function<void(const std::string&)>& ended);

}  // namespace dynwitness::crosscheck
