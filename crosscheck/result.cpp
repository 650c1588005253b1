// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/result.hpp"

#include <fmt/format.h>

namespace dynwitness::crosscheck {

const char* name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAgree: return "agree";
    case Verdict::kDisagree: return "disagree";
    case Verdict::kNotAnswerable: return "not answerable";
  }
  return "?";
}

std::string WitnessInfo::convention(const std::string& label) const {
  const std::string lines = "\n" + conventions + "\n";
  const std::string start = "\n" + label + ": ";
  const std::size_t at = lines.find(start);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + start.size();
  return lines.substr(begin, lines.find('\n', begin) - begin);
}

int CrosscheckResult::count(Verdict verdict) const {
  int count = 0;
  for (const SceneResult& scene : scenes)
    for (const CheckResult& check : scene.checks) count += check.verdict == verdict ? 1 : 0;
  return count;
}

int CrosscheckResult::checkCount() const {
  return count(Verdict::kAgree) + count(Verdict::kDisagree);
}

int CrosscheckResult::exactCount() const {
  int count = 0;
  for (const SceneResult& scene : scenes)
    for (const CheckResult& check : scene.checks)
      count += check.exact && check.exact->residual_zero ? 1 : 0;
  return count;
}

Verdict CrosscheckResult::verdict() const {
  if (count(Verdict::kDisagree) > 0) return Verdict::kDisagree;
  return count(Verdict::kAgree) > 0 ? Verdict::kAgree : Verdict::kNotAnswerable;
}

std::pair<const SceneResult*, const CheckResult*> CrosscheckResult::worst() const {
  std::pair<const SceneResult*, const CheckResult*> worst{nullptr, nullptr};
  for (const SceneResult& scene : scenes)
    for (const CheckResult& check : scene.checks)
      if (check.verdict != Verdict::kNotAnswerable && check.unit == "ulp" && !check.known_loss &&
          (worst.second == nullptr || !(check.ratio <= worst.second->ratio)))
        worst = {&scene, &check};
  return worst;
}

std::vector<CrosscheckResult::KnownLoss> CrosscheckResult::knownLosses() const {
  std::vector<KnownLoss> losses;
  for (const WitnessInfo& witness : witnesses) {
    KnownLoss loss{&witness, nullptr, 0};
    for (const SceneResult& scene : scenes) {
      for (const Finding& finding : scene.findings) {
        if (finding.kind != Finding::Kind::kKnownLoss || finding.witness != witness.name) continue;
        ++loss.scenes;
        if (loss.worst == nullptr || finding.digits < loss.worst->digits) loss.worst = &finding;
      }
    }
    if (loss.worst != nullptr) losses.push_back(loss);
  }
  return losses;
}

std::string CrosscheckResult::headline() const {
  const int disagreeing = count(Verdict::kDisagree), unanswered = count(Verdict::kNotAnswerable);
  std::string line = fmt::format("{} scene{}, {} checks, ", scenes.size(),
                                 scenes.size() == 1 ? "" : "s", checkCount());
  line += checkCount() == 0    ? std::string("nothing could be answered")
          : disagreeing == 0 ? std::string("all agree") : fmt::format("{} disagree", disagreeing);
  if (exactCount() > 0) line += fmt::format(", {} exactly", exactCount());
  if (unanswered > 0) line += fmt::format(", {} not answerable", unanswered);
  const auto [scene, check] = worst();
  if (check != nullptr)
    line += fmt::format("; worst {:.3g} ulp of {:.3g} allowed: {}, {} ({}{}{})", check->worst,
                        check->limit, scene->name, check->worst_entry, check->left,
                        check->right.empty() ? "" : " and ", check->right);
  return line;
}

}  // namespace dynwitness::crosscheck
