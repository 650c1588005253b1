// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/cli/crosscheck_tables.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "crosscheck/cli/speech.hpp"
#include "crosscheck/report/text.hpp"
#include "crosscheck/system/shell.hpp"
#include "crosscheck/verdicts/causes.hpp"
#include "crosscheck/verdicts/check_reading.hpp"

namespace dynwitness::cli {
namespace {

using namespace crosscheck;

/// A line a published motion: how many values, and how near the limit.
void printMotions(const CrosscheckResult& result) {
  for (const SceneResult& scene : result.scenes)
    for (const PublishedMotion& motion : scene.motions) {
      if (!motion.failure.empty()) continue;  // a disagreement, which is told with the others
      const auto fewest =
          std::min_element(motion.entries.begin(), motion.entries.end(),
                           [](const auto& a, const auto& b) { return a.digits < b.digits; });
      fmt::print("\npublished motion in {}: {}: {} values {}, {:.1f} digits or more, {}{}",
                 scene.name, motion.title, motion.values, motion.ratio <= 1 ? "agree" : "DISAGREE",
                 fewest->digits, ofLimit(motion.ratio, "the limit"),
                 motion.own.empty() ? "" : " (figures by another road of ours)");
    }
}

/// What of the scenes was read a second time, and who read a file of the user's own.
void printReading(const CrosscheckResult& result) {
  int again = 0, off = 0;
  std::map<std::string, int> not_read;   // scenes, by reason
  std::map<std::string, int> of_others;  // by who read the file itself
  for (const SceneResult& scene : result.scenes) {
    bool is_again = false, is_off = false;
    for (const CheckResult& check : scene.checks) {
      if (check.law != kReading) continue;
      if (check.asksNothing()) {
        ++not_read[check.reason];
        continue;
      }
      if (check.verdict == Verdict::kNotAnswerable) {
        ++not_read[check.reason];
        continue;
      }
      is_again = true;
      is_off = is_off || check.verdict == Verdict::kDisagree;
      if (const std::string who = whoReads(check); !who.empty()) ++of_others[who];
    }
    again += is_again ? 1 : 0;
    off += is_off ? 1 : 0;
  }
  fmt::print(
      "\nreading: the text of {} of {} scene{} was read, placed and weighed a second time, {}",
      again, result.scenes.size(), result.scenes.size() == 1 ? "" : "s",
      off > 0     ? fmt::format("{} DISAGREE", off)
      : again > 0 ? "and agrees"
                  : "so nobody but the readers of scenes vouches for it");
  for (const auto& [who, scenes] : of_others)
    fmt::print("\n  {} scene{}: {}", scenes, scenes == 1 ? "" : "s", who);
  for (const auto& [reason, scenes] : not_read)
    fmt::print("\n  {} scene{}: {}", scenes, scenes == 1 ? "" : "s", reason);
}

void printScenes(const CrosscheckResult& result) {
  fmt::print("{:<30} {:>4} {:>6} {:>7}  {:<15} {}\n", "scene", "dof", "links", "checks", "verdict",
             "closest to its limit, of rounding or another (an order, a drift)");
  for (const SceneResult& scene : result.scenes) {
    int disagreeing = 0, answered = 0, partly = 0;
    const CheckResult* closest = nullptr;
    for (const CheckResult& check : scene.checks) {
      if (check.verdict == Verdict::kNotAnswerable) continue;
      ++answered;
      disagreeing += check.verdict == Verdict::kDisagree ? 1 : 0;
      partly += check.voided > 0 ? 1 : 0;
      if (!check.known_loss && (closest == nullptr || check.ratio > closest->ratio))
        closest = &check;
    }
    const std::string verdict = disagreeing == 0 ? answered > 0 ? "agree" : "not answerable"
                                                 : fmt::format("{} DISAGREE", disagreeing);
    fmt::print("{:<30} {:>4} {:>6} {:>7}  {} ", scene.name, scene.dof, scene.links, answered,
               tonedVerdict(fmt::format("{:<15}", verdict)));
    if (closest != nullptr)
      fmt::print("{} {}, {}{}{}", ofLimit(closest->ratio, closest->name()), closest->quantity,
                 closest->left, closest->right.empty() ? "" : "/", closest->right);
    if (partly > 0) fmt::print("; {} check{} not at all states", partly, partly == 1 ? "" : "s");
    fmt::print("\n");
  }
}

/// One line a cause, unless the headline has said it, where its checks stand, and how to ask more.
void printCauses(const SceneResult& scene, bool is_said, const std::string& page,
                 const std::map<std::string, std::string>& asked) {
  for (const Cause& cause : causesOf(scene)) {
    fmt::print("\n{}: ", scene.name);
    if (!is_said) fmt::print("{}: {}\n  ", toned(Tone::kBad, "disagree"), cause.text);
    fmt::print("{} check{}, seed {}: {}", cause.checks.size(),
               cause.checks.size() == 1 ? " disagrees" : "s disagree", cause.checks.front()->seed,
               page);
    if (const auto program = asked.find(cause.witness); program != asked.end())
      fmt::print("\n  why: dynwitness check {} {}", shellWord(scene.name), program->second);
  }
}

/// What else a person should know, and what was not answered.
void printRemarks(const SceneResult& scene) {
  for (const Finding& finding : scene.findings)
    if (finding.kind == Finding::Kind::kOpenStart || finding.kind == Finding::Kind::kEngine)
      fmt::print("\nfinding: {}", finding.text);
  std::map<std::string, std::string> refused_by;                   // names, by reason
  std::map<std::string, std::vector<const CheckResult*>> unasked;  // checks, by reason
  for (const CheckResult& check : scene.checks) {
    if (check.verdict != Verdict::kNotAnswerable) continue;
    if (check.law == kReading && check.asksNothing()) continue;  // printReading() tells
    if (check.asksNothing()) {
      std::string& names = refused_by[check.reason];
      names += (names.empty() ? "" : ", ") + check.left;
    } else {
      unasked[check.reason].push_back(&check);
    }
  }
  for (const auto& [reason, checks] : unasked) {
    const CheckResult& first = *checks.front();
    fmt::print("\n{}: {}: {} {} ({}{}{}){}: {} (seed {})", scene.name, name(first.verdict),
               first.name(), first.quantity, first.left, first.right.empty() ? "" : " and ",
               first.right,
               checks.size() == 1   ? ""
               : checks.size() == 2 ? " and one more check"
                                    : fmt::format(" and {} more checks", checks.size() - 1),
               reason, first.seed);
  }
  for (const auto& [reason, names] : refused_by)
    fmt::print("\n{}: not answerable by {}: {}", scene.name, names, reason);
}

/// What agrees is said by the others: whom the run is without, and why. A line for each reason.
void printAbsent(const CrosscheckResult& result) {
  std::vector<std::pair<std::string, std::string>> names_by_reason;
  for (const WitnessInfo& witness : result.witnesses) {
    if (witness.present) continue;
    const std::string& reason = witness.absent;
    const auto same = std::find_if(names_by_reason.begin(), names_by_reason.end(),
                                   [&](const auto& it) { return it.first == reason; });
    if (same == names_by_reason.end())
      names_by_reason.emplace_back(reason, witness.name);
    else
      same->second += ", " + witness.name;
  }
  for (const auto& [reason, names] : names_by_reason) fmt::print("without {}: {}\n", names, reason);
}

}  // namespace

void printResult(const CrosscheckResult& result, const std::string& page,
                 const std::map<std::string, std::string>& asked) {
  fmt::print("{}\n{}\n",
             toned(exitStatus(result.verdict()) == 0 ? Tone::kGood : Tone::kBad, result.headline()),
             result.controlLine());
  printAbsent(result);
  fmt::print("\n");
  printScenes(result);
  std::size_t causes = 0;
  for (const SceneResult& scene : result.scenes) causes += causesOf(scene).size();
  for (const SceneResult& scene : result.scenes) {
    printCauses(scene, causes == 1, page, asked);
    printRemarks(scene);
  }
  printReading(result);
  printMotions(result);
  for (const CrosscheckResult::KnownLoss& loss : result.knownLosses())
    fmt::print("\nknown loss of {}, {} scene{}; worst in {}\n  cause: {}\n  remedy: {}\n",
               loss.witness->name, loss.scenes, loss.scenes == 1 ? "" : "s", loss.worst->text,
               loss.witness->convention("known loss"), loss.witness->convention("remedy"));
  fmt::print("\n");
}

}  // namespace dynwitness::cli
