// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/campaign.hpp"

#include <algorithm>
#include <iterator>
#include <regex>

#include <fmt/format.h>

#include "crosscheck/conductor/archive.hpp"
#include "crosscheck/conductor/ask_witnesses.hpp"
#include "crosscheck/conductor/exact_checks.hpp"
#include "crosscheck/system/processes.hpp"
#include "crosscheck/verdicts/check_mechanism.hpp"
#include "crosscheck/verdicts/compare.hpp"
#include "crosscheck/verdicts/digits.hpp"
#include "crosscheck/verdicts/options.hpp"

namespace dynwitness::crosscheck {
namespace {

void checkExactly(const PreparedScene& scene, const ExactOptions& options, RandomCampaign& campaign,
                  RandomCampaign::Failure& failure) {
  const std::vector<CheckResult> checks = exactChecks(scene, options);
  for (const CheckResult& check : checks) {
    const bool is_open = check.verdict == Verdict::kNotAnswerable;
    ++campaign.by_law[check.name()][check.is_idle ? 1 : is_open ? 2 : 0];
    if (check.is_idle) continue;  // a single body has no other root
    if (check.verdict != Verdict::kAgree) failure.checks.push_back(check);
    if (is_open) {
      ++campaign.not_answerable;
      continue;
    }
    ++campaign.checks;
    campaign.error_probability =
        std::max(campaign.error_probability, check.exact->error_probability);
  }
  failure.findings = findOutliers(scene.scene().name, checks);
}

/// A reason without what is the mechanism's own: its file, names in quotes, entries, states and
/// numbers.
std::string reasonInGeneral(const std::string& reason) {
  static const std::regex file("random_[0-9_]+\\.toml: "), quoted("'[^']*'|\"[^\"]*\""),
      entry("\\[[0-9,]+\\]"), number("([ (<=])[0-9][0-9.]*(e[-+]?[0-9]+)?");
  std::string text = std::regex_replace(std::regex_replace(reason, file, ""), quoted, "'...'");
  text = std::regex_replace(text, entry, "[...]");
  return std::regex_replace(text, number, "$1...");
}

/// @return whether there was a witness that does not build the mechanism
bool checkInDouble(const PreparedScene& scene, const CampaignOptions& options,
                   RandomCampaign& campaign, RandomCampaign::Failure& failure) {
  Options asked;
  asked.seed = options.exact.seed;
  asked.states = options.states;
  std::vector<CheckResult> checks;
  std::vector<Control>
      controls;  // a campaign over random mechanisms has no verdict on its own control
  DigitsFound truth = askWitnesses(scene, options.in_double, asked, checks, controls);
  std::move(truth.checks.begin(), truth.checks.end(), std::back_inserter(checks));
  bool refused = false;
  for (const WitnessKind& kind : options.in_double) ++campaign.asked[kind.info.name];
  for (const CheckResult& check : checks) {
    if (check.verdict == Verdict::kNotAnswerable) {
      const bool by_one = check.asksNothing();
      refused = refused || by_one;
      if (by_one) --campaign.asked[check.left];
      ++campaign.unanswered[reasonInGeneral(check.reason)][by_one ? check.left : check.quantity];
      continue;
    }
    campaign.comparisons += check.states;
    if (check.verdict == Verdict::kDisagree) failure.checks.push_back(check);
  }
  for (const CheckResult& check : checkMechanism(scene, asked)) {
    checks.push_back(check);
    if (check.verdict == Verdict::kNotAnswerable) {
      ++campaign.unanswered[reasonInGeneral(
          check.reason)][check.asksNothing() ? check.left + " (whole mechanism)" : check.quantity];
      continue;
    }
    campaign.comparisons += check.states;
    if (check.verdict == Verdict::kDisagree) failure.checks.push_back(check);
  }
  for (Finding& finding : findOutliers(scene.scene().name, checks))
    failure.findings.push_back(std::move(finding));
  return refused;
}

/// @param scene  the mechanism of this index
void checkOne(scene::Scene scene, int index, int max_joints, const CampaignOptions& options,
              RandomCampaign& campaign) {
  const auto keep = [&campaign](RandomCampaign::Failure failure) {
    if (!failure.checks.empty()) campaign.failures.push_back(std::move(failure));
  };
  RandomCampaign::Failure failure{std::move(scene), {}, {}};
  const PreparedScene prepared(failure.scene);
  checkExactly(prepared, options.exact, campaign, failure);
  ++campaign.mechanisms;
  campaign.joints += failure.scene.mechanism.dof();
  const bool refused =
      !options.in_double.empty() && checkInDouble(prepared, options, campaign, failure);
  keep(std::move(failure));
  if (!refused) return;
  RandomCampaign::Failure plain{
      randomScene(options.exact.seed, index, max_joints, JointKinds::kPlain), {}, {}};
  checkInDouble(plain.scene, options, campaign, plain);
  ++campaign.plain;
  keep(std::move(plain));
}

void append(RandomCampaign& all, RandomCampaign more) {
  all.mechanisms += more.mechanisms;
  all.joints += more.joints;
  all.checks += more.checks;
  all.not_answerable += more.not_answerable;
  for (const auto& [law, counts] : more.by_law)
    for (std::size_t k = 0; k < counts.size(); ++k) all.by_law[law][k] += counts[k];
  all.error_probability = std::max(all.error_probability, more.error_probability);
  all.plain += more.plain;
  all.comparisons += more.comparisons;
  for (const auto& [name, count] : more.asked) all.asked[name] += count;
  for (const auto& [reason, counts] : more.unanswered)
    for (const auto& [who, count] : counts) all.unanswered[reason][who] += count;
  std::move(more.failures.begin(), more.failures.end(), std::back_inserter(all.failures));
}

/// Who is asked exactly, where nobody is named: all but those whose making takes longer than the
/// rest.
CampaignOptions withWitnesses(CampaignOptions options) {
  if (options.exact.witnesses.empty())
    for (const WitnessKind& kind : witnessKinds())
      if (!kind.is_compiled) options.exact.witnesses.push_back(kind);
  return options;
}

/// @param index_of  the index of mechanism 0 to count - 1
RandomCampaign campaignOver(int count, const std::function<int(int)>& index_of, int max_joints,
                            const CampaignOptions& options, int processes,
                            const std::function<void(int)>& progress) {
  const CampaignOptions asked = withWitnesses(options);
  // mechanisms a task; of many mechanisms there are no more than so many tasks, whose parts are
  // kept
  constexpr int kLeast = 5, kMostTasks = 10000;
  const int block_size = std::max(kLeast, (count - 1) / kMostTasks + 1);
  int done = 0;
  const auto size = [=](int block) { return std::min(block_size, count - block * block_size); };
  const std::vector<std::string> parts = inProcesses(
      processes, (count - 1) / block_size + 1,
      [&](int block) {
        RandomCampaign part;
        for (int i = 0; i < size(block); ++i) {
          const int index = index_of(block * block_size + i);
          checkOne(
              randomWholeScene(asked.exact.seed, static_cast<std::uint64_t>(index), max_joints),
              index, max_joints, asked, part);
        }
        return archived(part);
      },
      [&](int block) {
        done += size(block);
        if (progress) progress(done);
      });
  RandomCampaign campaign;
  for (const std::string& part : parts) append(campaign, randomCampaignOf(part));
  return campaign;
}

}  // namespace

RandomCampaign crosscheckRandom(int count, int max_joints, const CampaignOptions& options,
                                int processes, const std::function<void(int)>& progress) {
  return campaignOver(
      count, [](int k) { return k; }, max_joints, options, processes, progress);
}

RandomCampaign crosscheckRandomOf(const std::vector<int>& indices, int max_joints,
                                  const CampaignOptions& options, int processes,
                                  const std::function<void(int)>& progress) {
  return campaignOver(
      static_cast<int>(indices.size()), [&](int k) { return indices[static_cast<std::size_t>(k)]; },
      max_joints, options, processes, progress);
}

RandomCampaign crosscheckDrawn(const scene::Scene& scene, int index, int max_joints,
                               const CampaignOptions& options) {
  RandomCampaign campaign;
  checkOne(scene, index, max_joints, withWitnesses(options), campaign);
  return campaign;
}

RandomCampaign::Failure disagreementsAbout(const scene::Scene& scene,
                                           const CampaignOptions& options) {
  const CampaignOptions asked = withWitnesses(options);
  RandomCampaign counts;  // which nobody reads here
  RandomCampaign::Failure failure{scene, {}, {}};
  const PreparedScene prepared(failure.scene);
  checkExactly(prepared, asked.exact, counts, failure);
  if (!asked.in_double.empty()) checkInDouble(prepared, asked, counts, failure);
  return failure;
}

std::string describeFailure(const RandomCampaign::Failure& failure) {
  std::string text;
  for (const Finding& finding : failure.findings) text += finding.text + "\n";
  for (const CheckResult& check : failure.checks)
    text += fmt::format("{}: {}: {}, {} ({}{}{}): {}\n", failure.scene.name, name(check.verdict),
                        check.name(), check.quantity, check.left,
                        check.right.empty() ? "" : " and ", check.right, check.reason);
  return text + fmt::format(
                    "to see it again: write the scene below to {0}, then\n"
                    "  dynwitness crosscheck {0} --seed {1}\n\n{2}",
                    failure.scene.file.string(), failure.checks.front().seed,
                    scene::writeSceneToml(failure.scene));
}

}  // namespace dynwitness::crosscheck
