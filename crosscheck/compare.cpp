// SPDX-License-Identifier: GPL-3.0-or-later
// Witnesses against each other, pair by pair, and who stands alone.
#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/crosscheck.hpp"
#include "crosscheck/states.hpp"
#include "crosscheck/tally.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr const char* kSame = "same";

/// What one witness said at one state.
struct Testimony {
  const Witness* witness;
  Answer answer;
  std::string failure;  ///< not empty: the witness threw this
};

}  // namespace

std::vector<WitnessKind> selectWitnesses(const std::vector<std::string>& names) {
  std::vector<WitnessKind> selected;
  std::string known;
  for (const WitnessKind& kind : witnessKinds()) {
    known += (known.empty() ? "" : ", ") + kind.info.name + (kind.info.present ? "" : " (absent)");
    const bool asked = names.empty() ? kind.info.present
                                     : std::count(names.begin(), names.end(), kind.info.name) > 0;
    if (asked && kind.info.present) selected.push_back(kind);
  }
  for (const std::string& name : names) {
    const bool found = std::any_of(selected.begin(), selected.end(),
                                   [&](const WitnessKind& k) { return k.info.name == name; });
    if (!found)
      throw scene::InputError({}, fmt::format("unknown witness '{}', allowed: {}", name, known));
  }
  return selected;
}

std::vector<CheckResult> compareWitnesses(const scene::Scene& scene,
                                          const std::vector<WitnessKind>& kinds,
                                          const Options& options) {
  std::vector<std::unique_ptr<Witness>> witnesses;
  for (const WitnessKind& kind : kinds) witnesses.push_back(makeWitness(kind, scene));

  std::vector<CheckResult> results;
  for (const Quantity quantity : kAllQuantities) {
    std::vector<Witness*> asked;
    for (const auto& witness : witnesses)
      if (witness->answers(quantity)) asked.push_back(witness.get());

    std::vector<Tally> tallies;
    for (std::size_t a = 0; a < asked.size(); ++a) {
      for (std::size_t b = a + 1; b < asked.size(); ++b) {
        CheckResult check;
        check.check = kSame;
        check.quantity = name(quantity);
        check.left = asked[a]->name();
        check.right = asked[b]->name();
        check.statement = fmt::format("{} by {} = {} by {}", check.quantity, check.left,
                                      check.quantity, check.right);
        check.seed = options.seed;
        tallies.emplace_back(check);
      }
    }
    if (tallies.empty()) continue;

    for (int k = 0; k < options.states; ++k) {
      const scene::State<double> state = drawState(scene.mechanism, scene.name, options.seed, k);
      std::vector<Testimony> said;
      for (Witness* witness : asked) {
        said.push_back({witness, {}, {}});
        try {
          said.back().answer = witness->answer(quantity, state);
        } catch (const std::exception& error) {
          said.back().failure = fmt::format("{}: {}", witness->name(), error.what());
        }
      }
      std::size_t pair = 0;
      for (std::size_t a = 0; a < said.size(); ++a) {
        for (std::size_t b = a + 1; b < said.size(); ++b, ++pair) {
          if (!said[a].failure.empty() || !said[b].failure.empty())
            tallies[pair].fail(k, said[a].failure.empty() ? said[b].failure : said[a].failure);
          else
            tallies[pair].add(k, said[a].answer.value, said[b].answer.value,
                              said[a].answer.bound + said[b].answer.bound);
        }
      }
    }
    for (const Tally& tally : tallies) results.push_back(tally.result());
  }
  return results;
}

std::vector<Finding> findOutliers(const std::string& scene_name,
                                  const std::vector<CheckResult>& checks) {
  std::vector<std::string> quantities;  // in dispute, in order
  for (const CheckResult& check : checks)
    if (check.check == kSame && check.verdict == Verdict::kDisagree &&
        std::count(quantities.begin(), quantities.end(), check.quantity) == 0)
      quantities.push_back(check.quantity);

  std::vector<Finding> findings;
  for (const std::string& quantity : quantities) {
    std::map<std::string, int> disputes, pairs;  // by witness
    int disputed = 0, agreed = 0;
    for (const CheckResult& check : checks) {
      if (check.check != kSame || check.quantity != quantity ||
          check.verdict == Verdict::kNotAnswerable)
        continue;  // a witness that could not answer neither agrees nor disagrees
      const int disagrees = check.verdict == Verdict::kDisagree ? 1 : 0;
      disputed += disagrees;
      agreed += 1 - disagrees;
      for (const std::string& witness : {check.left, check.right}) {
        disputes[witness] += disagrees;
        ++pairs[witness];
      }
    }
    std::optional<std::string> outlier;
    if (pairs.size() >= 3 && agreed > 0)  // of two that disagree, neither stands alone
      for (const auto& [witness, count] : disputes)
        if (count == pairs[witness] && count == disputed) outlier = witness;
    std::string others;
    for (const auto& [witness, count] : disputes)
      if (witness != outlier.value_or("")) others += (others.empty() ? "" : ", ") + witness;
    Finding finding{scene_name, quantity, outlier.value_or(""), ""};
    finding.text =
        outlier ? fmt::format("{}: {}: {} stands alone; {} agree with each other", scene_name,
                              quantity, *outlier, others)
                : fmt::format("{}: {}: {} disagree, and no single one stands alone", scene_name,
                              quantity, others);
    findings.push_back(finding);
  }
  return findings;
}

}  // namespace dynwitness::crosscheck
