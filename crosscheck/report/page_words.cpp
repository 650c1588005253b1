// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/report/page_words.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace dynwitness::crosscheck {

std::string plural(long n, const char* word) {
  return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s");
}

const char* cssClass(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAgree:
      return "agree";
    case Verdict::kDisagree:
      return "disagree";
    case Verdict::kNotAnswerable:
      break;
  }
  return "none";
}

const char* cssClass(RunVerdict verdict) {
  switch (verdict) {
    case RunVerdict::kAgree:
      return "agree";
    case RunVerdict::kNotAnswerable:
      return "none";
    case RunVerdict::kIncomplete:
    case RunVerdict::kProvesNothing:
    case RunVerdict::kDisagree:
      break;
  }
  return "disagree";
}

std::string badge(Verdict verdict, const std::string& word) {
  return badge(cssClass(verdict), word);
}

std::string quantityWords(const std::string& quantity) {
  static const std::map<std::string, const char*> kWords = {
      {"M", "M, mass matrix"},
      {"c", "c, velocity products"},
      {"g", "g, gravity and springs"},
      {"tau", "tau, inverse dynamics"},
      {"qdd", "qdd, forward dynamics"},
      {"energy", "energy along simulated motion"},
      {"motion", "simulated motion against published ones"},
      {"kinetic", "kinetic energy"},
      {"potential", "potential energy"},
      {"momentum", "momentum"},
      {"reactions", "reactions"},
      {"mechanism qdd", "qdd of the whole mechanism: closures, springs, drives and constraints"},
      {"mechanism constraint force",
       "J' lambda of the whole mechanism, joint forces of constraints"},
      {"mechanism lambda", "lambda of the whole mechanism, closures"},
      {"mechanism nu", "nu of the whole mechanism, acceleration constraints"},
      {"mechanism drive force", "forces of the drives of the whole mechanism"},
      {"mechanism reactions", "reactions of the whole mechanism, what its joints transmit"},
      {"placements", "placements, read a second time"},
      {"masses", "masses, read a second time"},
      {"numbers", "other numbers, read a second time"},
  };
  const auto found = kWords.find(quantity);
  return found != kWords.end() ? found->second : quantity.empty() ? "other" : quantity;
}

std::string witnessesOf(const CheckResult& check) {
  if (check.right.empty()) return esc(check.left);
  return esc(check.left) + " <span class=\"soft\">and</span> " + esc(check.right);
}

bool answered(const CheckResult& check) {
  return check.verdict != Verdict::kNotAnswerable;
}

bool drawn(const CheckResult& check) {
  return !check.worst_entry.empty();
}

std::string worstAt(const CheckResult& check) {
  if (!drawn(check)) return "–";
  return fmt::format("{}<span class=\"sub\">state {} of {}, seed {}</span>", esc(check.worst_entry),
                     check.worst_state, check.states, check.seed);
}

std::string share(const CheckResult& check) {
  const bool over = !(check.ratio <= 1);
  const double part = over ? 100 : std::max(0.0, 100 * check.ratio);
  return fmt::format(
      R"(<span class="bar{}" aria-hidden="true"><i style="--part:{:.1f}%"></i></span><span class="percent">{}</span>)",
      over ? " over" : "", part, esc(shareOfLimit(check.ratio)));
}

double severity(const CheckResult& check) {
  if (!answered(check)) return -1;
  if (check.known_loss && check.verdict == Verdict::kAgree) return 0;
  if (std::isnan(check.ratio)) return std::numeric_limits<double>::infinity();
  return check.ratio + (check.verdict == Verdict::kDisagree ? 1e6 : 0);
}

SceneCounts count(const SceneResult& scene) {
  SceneCounts counts;
  for (const CheckResult& check : scene.checks) {
    switch (check.verdict) {
      case Verdict::kAgree:
        ++counts.agree;
        break;
      case Verdict::kDisagree:
        ++counts.disagree;
        break;
      case Verdict::kNotAnswerable:
        ++counts.not_answerable;
        continue;
    }
    if (counts.worst == nullptr || severity(check) > severity(*counts.worst)) counts.worst = &check;
  }
  return counts;
}

std::string sceneTitle(const SceneResult& scene) {
  return scene.title.empty() ? scene.name : scene.title;
}

void openScroll(std::string* page, const std::string& label) {
  put(page, "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{}\">\n",
      esc(label));
}

}  // namespace dynwitness::crosscheck
