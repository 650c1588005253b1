// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a shard: lines that are added and never changed, each with a seal, so that what a
// KILL, a full disk or a bad copy has damaged is known and left out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dynwitness::crosscheck {

/** A line of a ledger is a JSON object,

        {"seal":"32 hexadecimal digits","record":{...},"besides":{...}}

    the seal being hashOf() of all that stands after it. `record` is the same whoever computes it;
    `besides` is what is not: how long it took.
    @param record, besides  JSON objects in one line
    @return  the line, with its newline */
std::string sealedLine(std::string_view record, std::string_view besides);

/// The record and the rest of an intact line, as they stand there.
struct SealedLine {
  std::string_view record, besides;
};
/// @param line  without its newline
/// @return whether it is intact
bool opened(std::string_view line, SealedLine* out);

/// Which campaign a ledger belongs to: its first intact line.
struct LedgerHead {
  std::string version;  ///< of dynwitness, with the commit where it is known
  std::string plan;     ///< CampaignPlan::text
  long cases = 0;       ///< of the whole campaign
  int shard = 1, shards = 1;

  long casesOfShard() const { return (cases - shard) / shards + 1; }
  /// As a record.
  std::string text() const;
};

/// Where the record of a case stands.
struct LedgerEntry {
  long number;           ///< of the case
  int file;              ///< index of the ledger
  std::uint64_t offset;  ///< of the record
  std::uint32_t size;
  double seconds;      ///< that the case took
  std::uint64_t hash;  ///< of the record
  bool has_failed;     ///< its verdict is "failed": another run of it may come farther
};

/// What a ledger is found to be.
struct ShardLedger {
  std::filesystem::path file;
  bool has_head = false;  ///< otherwise nothing in it counts
  LedgerHead head;
  long entries = 0;
  std::vector<long> damaged;  ///< line numbers from 1; the last one may just lack its end
  bool ends_in_a_line = true;
  double seconds = 0;  ///< of all its cases
};

/// The head alone; none where there is no intact one.
std::optional<LedgerHead> headOf(const std::filesystem::path& file);

/** Reads a ledger once, from its begin to its end, line by line.
    @param entry  is given every case that stands there, in the order of the file
    @throws scene::InputError  it cannot be read */
ShardLedger readShardLedger(
    const std::filesystem::path& file, int index,
    const std::function<void(const LedgerEntry&, std::string_view record)>& entry);

/// The ledgers of a folder ("shard-1-of-4.jsonl"), in the order of their names.
std::vector<std::filesystem::path> ledgersIn(const std::filesystem::path& folder);

/** A ledger that this process alone adds to: others that try are refused until it ends, also over
    NFS. A line is added by one write(); where the last one lacks its end, that stays behind as a
    damaged line. */
class GrowingLedger {
 public:
  /** @throws scene::InputError  the folder cannot be written to, or another process adds to the
                                 file */
  GrowingLedger(const std::filesystem::path& folder, const LedgerHead& head);
  ~GrowingLedger();
  GrowingLedger(const GrowingLedger&) = delete;
  GrowingLedger& operator=(const GrowingLedger&) = delete;

  /// @throws std::runtime_error  the system's reason, such as a full disk
  void add(std::string_view lines);
  /// Waits until the disk has what was added.
  void settle();
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace dynwitness::crosscheck
