// SPDX-License-Identifier: GPL-3.0-or-later
// One case of a campaign: what is tried, and what is written down of it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/campaign/campaign_plan.hpp"
#include "crosscheck/conductor/campaign.hpp"

namespace dynwitness::crosscheck {

/// Of a case: nothing disagrees or failed.
inline bool isRight(const std::string& verdict) {
  return verdict == "agree" || verdict == "not answerable";
}

/** Runs cases of a plan. A case is a function of the plan and its number: whoever runs it, and
    when, finds the same.

    Its record is a JSON object in one line: `case`, `of`, `name`, `verdict` ("agree", "disagree",
    "not answerable", "failed"), and
      of mechanisms  `rates`, `depth`, `branches` (most joints on one link), `kinds`, `exact`
      checks,
                     `not_answerable`, `chance`, `comparisons` in double, and `pairs`, a bit each of
                     pairsOf() in hexadecimal digits, the first digit the first four
      of scenes      `checks`, `exact`
      of commands    `status`
    What disagrees has a `cause` besides (equal for what is probably one fault), `failure` (in
    words, and how to see it again), and a mechanism `small`, the scene that smaller() makes of
    it. */
class CaseRunner {
 public:
  /// @param program  of dynwitness, for commands
  /// @param kinds    witnesses of mechanisms; empty: all that are not compiled
  CaseRunner(CampaignPlan plan, std::filesystem::path program, std::vector<WitnessKind> kinds = {});

  /// The line of a ledger: the record, how long it took, and what a command has said that failed.
  /// What the case throws is its verdict, "failed", but for want of memory.
  std::string line(long number) const;
  /// The line of a case whose process ended.
  std::string lineOfFailed(long number, const std::string& problem, double seconds) const;

  const CampaignPlan& plan() const { return plan_; }

 private:
  CampaignOptions optionsOf(const CampaignPart& part) const;
  /// Which random mechanism a case is about.
  int indexOf(const CampaignPart& part, long index) const;

  CampaignPlan plan_;
  std::filesystem::path program_;
  std::vector<WitnessKind> kinds_;
  std::vector<double> rarity_;  ///< by pair, where a part has draws
};

}  // namespace dynwitness::crosscheck
