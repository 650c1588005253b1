// SPDX-License-Identifier: GPL-3.0-or-later
// What all shards of a campaign have found together.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "crosscheck/campaign/shard_ledger.hpp"
#include "crosscheck/inputs/feature_pairs.hpp"

namespace dynwitness::crosscheck {

/// The ledgers of some folders, and what is wrong with them.
struct GatheredLedgers {
  LedgerHead head;                   ///< version and plan that all that count have in common
  std::vector<ShardLedger> ledgers;  ///< that count
  std::vector<LedgerEntry> entries;  ///< one a case, in ascending order
  long twice = 0;  ///< cases that stood in more than one place, with the same record
  std::vector<std::string> left_out;  ///< files and lines that do not count, each with the reason
  /// Cases that nobody has, as ranges: "17", "20-39".
  std::vector<std::string> missing;
  long missing_cases = 0;

  double seconds() const;  ///< that all cases took
};

/** Reads them all. Damaged lines, ledgers without a head and ledgers of another version than this
    program's are left out and named. Of a case that failed with its process and that another run
    answered the answer counts.

    @throws scene::InputError  a folder that does not exist or has no ledger, ledgers of different
      plans, a case with two different records: what must be a function of its number is none */
GatheredLedgers gatherLedgers(const std::vector<std::filesystem::path>& folders);

/// What of random mechanisms was met.
struct CampaignCoverage {
  std::map<std::string, long> kinds;            ///< joints by kind
  std::map<int, long> rates, depths, branches;  ///< mechanisms by them
  PairTable pairs;
  /// Mechanisms that agree and have this feature, and with it the terms that it brings into the
  /// equations. (All features of one stand in pairs, since it has gravity or has none.)
  std::map<std::string, long> terms;
  /// Mechanisms by each of exactCheckNames(): where it was decided, where there was nothing to ask,
  /// where it was not answerable. What was never met stands there with zeros.
  std::map<std::string, std::array<long, 3>> laws;
};

/** Where n independent draws agree: at most this share of all that are drawn so would not, said
    with 95 % confidence; the p with (1 - p)^n = 0.05. 1 for none. */
double shareAtMostOf(long agreeing);

struct CampaignSum {
  long cases = 0;
  std::map<std::string, long> verdicts;
  std::map<std::string, std::map<std::string, long>> of;  ///< verdicts by kind of case
  long exact_checks = 0, comparisons = 0;
  long not_answerable = 0;  ///< exact checks
  long mechanisms = 0;      ///< random ones that agree or disagree
  long mechanisms_that_agree = 0;
  double chance = 0;  ///< sum over exact checks of the chance that a wrong formula passes
  CampaignCoverage coverage;
  /// By cause: how many cases, and the record of the first.
  struct Cause {
    long cases = 0;
    long first = 0;
    std::string record;
  };
  std::map<std::string, Cause> causes;

  /// Of mechanisms whose formulas differ: shareAtMostOf() all that were drawn; 1 where one
  /// disagrees.
  double shareAtMost() const;
  bool isRight() const;  ///< nothing disagrees or failed
};

/** Adds up, and writes every record, by number of its case, to folder/cases.jsonl (sealed lines
    without what depends on who ran them), and to folder/campaign.json what all come to: the same
    bytes whatever the order and the number of shards.
    @throws std::runtime_error  a file cannot be written; neither is there then */
CampaignSum writeMerged(const GatheredLedgers& gathered, const std::filesystem::path& folder);

/// campaign.json (campaign.schema.json of this folder).
std::string campaignSumJson(const GatheredLedgers& gathered, const CampaignSum& sum);

/// For people.
std::string describeSum(const GatheredLedgers& gathered, const CampaignSum& sum);

}  // namespace dynwitness::crosscheck
