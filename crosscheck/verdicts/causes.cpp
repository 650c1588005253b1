// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/causes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/verdicts/check_reading.hpp"

namespace dynwitness::crosscheck {
namespace {

bool has(const std::vector<std::string>& list, const std::string& one) {
  return std::find(list.begin(), list.end(), one) != list.end();
}

/// Quantities that this one is made of, or of whose derivatives.
std::vector<std::string> partsOf(const std::string& quantity) {
  static const std::vector<std::string> kForces = {"M", "c", "g", "tau"};
  static const std::map<std::string, std::vector<std::string>> kParts = {
      {"c", {"M"}},        {"tau", {"M", "c", "g"}}, {"qdd", kForces},       {"kinetic", {"M"}},
      {"momentum", {"M"}}, {"potential", {"g"}},     {"reactions", kForces},
  };
  if (quantity.rfind("mechanism ", 0) == 0) return kForces;
  const auto found = kParts.find(quantity);
  return found == kParts.end() ? std::vector<std::string>() : found->second;
}

/// What a check that no single witness is to blame for is gathered under.
std::string keyOf(const CheckResult& check, bool is_misread) {
  if (check.law == kReading || (is_misread && check.kind == CheckKind::kTable)) return kReading;
  switch (check.kind) {
    case CheckKind::kTable:
      return "table " + check.statement;
    case CheckKind::kSame:
    case CheckKind::kTruth:
      return "quantity";
    default:
      return "by " + check.left;
  }
}

/// Parted into what contains another quantity in dispute, and what does not.
void partQuantities(Cause& cause) {
  std::vector<std::string> all;
  for (const CheckResult* check : cause.checks)
    if (check->kind == CheckKind::kSame || check->kind == CheckKind::kTruth)
      addOnce(all, check->quantity);
  for (const std::string& quantity : all) {
    const std::vector<std::string> parts = partsOf(quantity);
    const bool follows = std::any_of(parts.begin(), parts.end(),
                                     [&](const std::string& part) { return has(all, part); });
    (follows ? cause.following : cause.wrong).push_back(quantity);
  }
}

/// Joints and figures: those of tau, if it is wrong, which a user knows best.
void putFigures(Cause& cause) {
  for (const CheckResult* check : cause.checks) {
    for (const std::string& joint : check->wrong_joints) addOnce(cause.joints, joint);
    if (check->off && (cause.off == nullptr || check->quantity == "tau")) cause.off = &*check->off;
  }
}

std::string whichJoints(const Cause& cause, int dof) {
  constexpr std::size_t kMost = 5;
  if (cause.joints.empty()) return "";
  if (static_cast<int>(cause.joints.size()) == dof)
    return dof == 1 ? "" : fmt::format("; wrong at all {} joints", dof);
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < std::min(kMost, cause.joints.size()); ++i)
    shown.push_back("'" + cause.joints[i] + "'");
  if (cause.joints.size() > kMost)
    shown.push_back(fmt::format("{} more", cause.joints.size() - kMost));
  return fmt::format("; wrong at joint{} {} of {}", cause.joints.size() == 1 ? "" : "s",
                     listed(shown), dof);
}

/// "tau[3] is off by 3.1 N m where 12 N m is right, at state 7"
std::string offAt(const CheckResult::Off& off) {
  return fmt::format("{} {}, at state {}", off.entry, figures(off), off.state);
}

/// "stranger stands alone in M; tau[3] is off by ..; wrong at joints ..; so are c and tau, which
/// contain it; right in g"
std::string textOfWitness(const Cause& cause, int dof) {
  std::string text = fmt::format("{} stands alone", cause.witness);
  if (!cause.wrong.empty()) text += " in " + listed(cause.wrong);
  text += "; " + (cause.off != nullptr ? offAt(*cause.off) : cause.checks.front()->reason);
  text += whichJoints(cause, dof);
  if (!cause.following.empty())
    text +=
        fmt::format("; so {} {}, which contain{} {}", cause.following.size() == 1 ? "is" : "are",
                    listed(cause.following), cause.following.size() == 1 ? "s" : "",
                    cause.wrong.size() == 1 ? "it" : "them");
  if (!cause.right.empty()) text += "; right in " + listed(cause.right);
  return text;
}

/// Of what nobody stands alone in.
std::string textOfOthers(const Cause& cause, const std::string& key) {
  const CheckResult& first = *cause.checks.front();
  if (key == kReading) {
    const auto read = std::find_if(cause.checks.begin(), cause.checks.end(),
                                   [](const CheckResult* check) { return check->law == kReading; });
    return fmt::format(
        "the file, read a second time, says otherwise than the scene that all witnesses were "
        "told: {}",
        (*read)->reason);
  }
  if (key == "quantity") {
    std::vector<std::string> who;
    for (const CheckResult* check : cause.checks)
      for (const std::string& witness : {check->left, check->right})
        if (!witness.empty()) addOnce(who, witness);
    std::vector<std::string> quantities = cause.wrong;
    quantities.insert(quantities.end(), cause.following.begin(), cause.following.end());
    return fmt::format("{} disagree in {}, and no single one stands alone", listed(who),
                       listed(quantities));
  }
  if (first.kind == CheckKind::kTable) {
    std::vector<std::string> who;
    for (const CheckResult* check : cause.checks) addOnce(who, check->right);
    return fmt::format("a table stands against {}: {}", listed(who), first.reason);
  }
  std::vector<std::string> laws;
  for (const CheckResult* check : cause.checks) addOnce(laws, check->name());
  return fmt::format("{}: {}: {}", first.left, listed(laws), first.reason);
}

/// Witnesses that stand alone, the one with the most disagreements first.
std::vector<std::string> standingAlone(const SceneResult& scene) {
  std::vector<std::string> alone;
  for (const Finding& finding : scene.findings)
    if (finding.kind == Finding::Kind::kDisagreement && !finding.witness.empty() &&
        finding.witness != kRereading && finding.witness != "table")
      addOnce(alone, finding.witness);
  std::map<std::string, int> disagreements;
  for (const CheckResult& check : scene.checks)
    if (check.verdict == Verdict::kDisagree)
      for (const std::string& witness : {check.left, check.right}) ++disagreements[witness];
  std::stable_sort(alone.begin(), alone.end(), [&](const std::string& a, const std::string& b) {
    return disagreements[a] > disagreements[b];
  });
  return alone;
}

/// Quantities of the witness that are within its limits of the certified truth.
std::vector<std::string> rightOf(const std::string& witness, const SceneResult& scene) {
  std::vector<std::string> right;
  for (const CheckResult& check : scene.checks)
    if (check.kind == CheckKind::kTruth && check.left == witness &&
        check.verdict == Verdict::kAgree)
      right.push_back(check.quantity);
  return right;
}

}  // namespace

std::string figures(const CheckResult::Off& off) {
  const std::string unit = off.unit.empty() ? "" : " " + off.unit;
  constexpr double kFactor = 10;  // beyond 1000 %, percent say nothing
  const double by = std::abs(off.said - off.right);
  if (!std::isfinite(off.said))
    return fmt::format("is not a number where {:.3g}{} is right", off.right, unit);
  if (off.right == 0) return fmt::format("is {:.3g}{} where 0 is right", off.said, unit);
  if (by > kFactor * std::abs(off.right))
    return fmt::format("is {:.3g}{} where {:.3g}{} is right, {:.2g} times that{}", off.said, unit,
                       off.right, unit, std::abs(off.said / off.right),
                       off.said / off.right < 0 ? " the other way" : "");
  return fmt::format("is off by {:.3g}{} where {:.3g}{} is right", by, unit, off.right, unit);
}

std::vector<Cause> causesOf(const SceneResult& scene) {
  const std::vector<std::string> alone = standingAlone(scene);
  const bool is_misread =
      std::any_of(scene.checks.begin(), scene.checks.end(), [](const CheckResult& check) {
        return check.law == kReading && check.verdict == Verdict::kDisagree;
      });
  std::vector<std::pair<std::string, Cause>> causes;  // by key
  for (const CheckResult& check : scene.checks) {
    if (check.verdict != Verdict::kDisagree) continue;
    const auto who = std::find_if(alone.begin(), alone.end(), [&](const std::string& witness) {
      return witness == check.left || witness == check.right;
    });
    const std::string key = who == alone.end() ? keyOf(check, is_misread) : "witness " + *who;
    auto at = std::find_if(causes.begin(), causes.end(),
                           [&](const auto& known) { return known.first == key; });
    if (at == causes.end()) {
      at = causes.insert(at, {key, {}});
      at->second.scene = scene.name;
      if (who != alone.end()) at->second.witness = *who;
    }
    at->second.checks.push_back(&check);
  }
  std::vector<Cause> out;
  for (auto& [key, cause] : causes) {
    partQuantities(cause);
    putFigures(cause);
    if (!cause.witness.empty()) cause.right = rightOf(cause.witness, scene);
    cause.text = cause.witness.empty() ? textOfOthers(cause, key) : textOfWitness(cause, scene.dof);
    if (cause.witness.empty() && cause.off != nullptr) cause.text += "; " + offAt(*cause.off);
    out.push_back(std::move(cause));
  }
  std::stable_sort(out.begin(), out.end(), [](const Cause& a, const Cause& b) {
    return a.checks.size() > b.checks.size();
  });
  return out;
}

}  // namespace dynwitness::crosscheck
