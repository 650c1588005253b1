// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/campaign.hpp"

#include <algorithm>
#include <cstdio>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crosscheck/cli/standard_files.hpp"
#include "crosscheck/report/json.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;
using Json = nlohmann::ordered_json;

constexpr int kStages = 20;
constexpr double kLong = 30;  ///< [s], from here on it is told beforehand

/// "40 s", "5 min", "3.2 h"
std::string roughly(double seconds) {
  if (seconds < 100) return fmt::format("{:.0f} s", seconds);
  if (seconds < 100 * 60) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

/// "1000 mechanisms", "1 mechanism"
std::string counted(long n, const std::string& what) {
  return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

/// "kdl 13, mujoco 12"
std::string listed(const std::map<std::string, int>& counts) {
  std::string text;
  for (const auto& [name, count] : counts)
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
  return text;
}

}  // namespace

CampaignProgress::CampaignProgress(int mechanisms)
    : mechanisms_(mechanisms), progress_(kStages, 1.0) {}

void CampaignProgress::show(int done) {
  const double taken =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  const double left = taken * (mechanisms_ - done) / done;
  if (!told_ && taken > 1) {
    told_ = true;
    if (left > kLong)
      tell(fmt::format("dynwitness: {} take about {}\n", counted(mechanisms_, "mechanism"),
                       roughly(taken + left)));
  }
  for (; stage_ < kStages && 1L * done * kStages >= (stage_ + 1L) * mechanisms_; ++stage_)
    progress_.stage(fmt::format("{} of {}, about {} to go", done, counted(mechanisms_, "mechanism"),
                                roughly(left)));
}

void printCampaign(const RandomCampaign& campaign, const CampaignOptions& options) {
  const auto verdict = [&](bool is_exact) {
    const auto disagrees = [&](const RandomCampaign::Failure& failure) {
      return std::any_of(
          failure.checks.begin(), failure.checks.end(),
          [&](const CheckResult& check) { return (check.unit == Unit::kExact) == is_exact; });
    };
    const long failed =
        std::count_if(campaign.failures.begin(), campaign.failures.end(), disagrees);
    return failed == 0 ? "all agree" : counted(failed, "mechanism") + " DISAGREE";
  };
  fmt::print(
      "{}, {}, {}, {}{}; chance that a wrong formula passes "
      "one at most {:.1g} (seed {})\n",
      counted(campaign.mechanisms, "random mechanism"), counted(campaign.joints, "joint"),
      counted(campaign.checks, "exact check"), verdict(true),
      campaign.not_answerable > 0 ? fmt::format(", {} not answerable", campaign.not_answerable)
                                  : "",
      campaign.error_probability, options.exact.seed);
  if (!options.in_double.empty()) {
    fmt::print("in double at {}{}: {}, {}\n", counted(options.states, "state"),
               campaign.plain == 0
                   ? " each"
                   : fmt::format(" each, {} more of plain joints, for witnesses that refuse others",
                                 campaign.plain),
               counted(campaign.comparisons, "comparison"), verdict(false));
    fmt::print("mechanisms asked about: {}\n", listed(campaign.asked));
    for (const auto& [reason, counts] : campaign.unanswered)
      fmt::print("not answerable: {} ({})\n", reason, listed(counts));
  }
  for (const RandomCampaign::Failure& failure : campaign.failures)
    fmt::print("\n{}\n", describeFailure(failure));
}

std::string campaignJson(const RandomCampaign& campaign, const CampaignOptions& options,
                         int max_joints, const std::string& pairs) {
  Json json{{"dynwitness", DYNWITNESS_VERSION},
            {"command", pairs.empty() ? "crosscheck --mechanisms" : "crosscheck --pairs"},
            {"seed", options.exact.seed},
            {"most_joints", max_joints},
            {"states", options.states},
            {"mechanisms", campaign.mechanisms},
            {"joints", campaign.joints},
            {"exact_checks", campaign.checks},
            {"exact_not_answerable", campaign.not_answerable},
            {"error_probability", campaign.error_probability},
            {"mechanisms_of_plain_joints_besides", campaign.plain},
            {"comparisons_in_double", campaign.comparisons},
            {"mechanisms_asked_about", campaign.asked},
            {"not_answerable", campaign.unanswered},
            {"failures", Json::array()}};
  for (const RandomCampaign::Failure& failure : campaign.failures) {
    Json one{{"file", failure.scene.file.string()},
             {"scene", scene::writeSceneToml(failure.scene)},
             {"findings", Json::array()},
             {"checks", Json::array()}};
    for (const Finding& finding : failure.findings) one["findings"].push_back(finding.text);
    for (const CheckResult& check : failure.checks)
      one["checks"].push_back(Json::parse(checkJson(check)));
    json["failures"].push_back(one);
  }
  if (!pairs.empty()) json["pairs"] = Json::parse(pairs);
  json["verdict"] = campaign.failures.empty() ? "agree" : "disagree";
  return json.dump(2) + "\n";
}

}  // namespace dynwitness::cli
