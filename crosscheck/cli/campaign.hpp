// SPDX-License-Identifier: GPL-3.0-or-later
// How a campaign over random mechanisms shows itself: while it runs, in words, and as JSON.
#pragma once

#include <chrono>
#include <string>

#include "crosscheck/cli/progress.hpp"
#include "crosscheck/conductor/campaign.hpp"

namespace dynwitness::cli {

/// Twenty stages, each with the time that is left; how long all will take is told once when it is
/// long.
class CampaignProgress {
 public:
  explicit CampaignProgress(int mechanisms);
  void show(int done);

 private:
  int mechanisms_, stage_ = 0;
  bool told_ = false;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  Progress progress_;
};

/// The result text: how many, who was asked, what could not be answered and why, and each failure.
void printCampaign(const crosscheck::RandomCampaign& campaign,
                   const crosscheck::CampaignOptions& options);

/// The same for programs; each failure with its scene as TOML, and its checks as in report.json.
/// @param pairs  what pairsJson() wrote; may be empty
std::string campaignJson(const crosscheck::RandomCampaign& campaign,
                         const crosscheck::CampaignOptions& options, int max_joints,
                         const std::string& pairs = {});

}  // namespace dynwitness::cli
