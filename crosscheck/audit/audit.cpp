// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/audit/audit.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <stdexcept>

#include <fmt/format.h>

#include "crosscheck/audit/ours.hpp"
#include "scene/error.hpp"

namespace dynwitness::audit {

const char* name(Holds holds) {
  switch (holds) {
    case Holds::kTrue:
      return "true";
    case Holds::kUnderCondition:
      return "under condition";
    case Holds::kFalse:
      break;
  }
  return "false";
}

namespace {

/// What a statement has and its trials lack, or the other way round, is refused.
void requireBoth(const Statement& statement, const std::string& what, bool said, bool computed) {
  if (said == computed) return;
  throw scene::InputError(
      statement.where,
      "statement \"" + statement.id + "\": " +
          (said ? "has a " + what + " that crosscheck/audit/ does not compute, allowed: none"
                : "has no " + what + ", allowed: one, as crosscheck/audit/ computes it"));
}

}  // namespace

std::string Entry::kind() const {
  return left_open ? "open item" : not_printed ? "remark" : isEquation() ? "equation" : "sentence";
}

bool Entry::comparesOurCode() const {
  return residual_ours || (residual_corrected && residual_corrected->our_code);
}

bool Entry::isSound() const {
  if (residual_corrected && !residual_corrected->zero) return false;
  if (residual_condition && !residual_condition->zero) return false;
  if (residual_ours && !residual_ours->zero) return false;
  return holds == Holds::kTrue || residual_corrected.has_value();
}

Entry evaluate(const Claim& claim, std::uint64_t seed) {
  const Trials& trials = claim.trials;
  if (!trials.printed_trial) throw std::logic_error(trials.id + ": nothing to compute");
  Entry entry{claim.statement, Holds::kFalse, {}, {}, {}, {}, {}};
  const std::string name = "audit " + entry.id;
  entry.residual_printed = trials.printed_trial(name, seed);
  if (trials.corrected_trial) entry.residual_corrected = trials.corrected_trial(name, seed);
  if (trials.condition_trial) entry.residual_condition = trials.condition_trial(name, seed);
  for (const Outcome* outcome :
       {&entry.residual_printed, entry.residual_condition ? &*entry.residual_condition : nullptr})
    if (outcome && outcome->our_code)
      throw std::logic_error(trials.id + ": our code decides what the chapter says");
  const bool has_its_own = entry.residual_corrected && entry.residual_corrected->our_code;
  const Trial ours =
      trials.ours_trial || has_its_own ? trials.ours_trial : oursOf(entry.implemented_in);
  if (ours) entry.residual_ours = ours(name, seed);
  if (trials.rows_of_numbers)
    entry.numbers = Numbers{entry.numbers_caption, entry.numbers_head, trials.rows_of_numbers()};
  if (entry.numbers)
    for (const auto& row : entry.numbers->rows)
      if (row.size() != entry.numbers_head.size())
        throw scene::InputError(entry.where,
                                fmt::format("statement \"{}\": numbers_head: {} heads, allowed: {}",
                                            entry.id, entry.numbers_head.size(), row.size()));
  if (entry.residual_printed.zero)
    entry.holds = Holds::kTrue;
  else if (entry.residual_condition && entry.residual_condition->zero)
    entry.holds = Holds::kUnderCondition;
  return entry;
}

std::vector<Trials> allTrials() {
  std::vector<Trials> all;
  for (const auto& group :
       {frames, rigidBody, projections, recursions, algorithms, constrainedSystems, constraints,
        tasks, analytical, lagrange, impedances, geometry}) {
    std::vector<Trials> trials = group();
    std::move(trials.begin(), trials.end(), std::back_inserter(all));
  }
  return all;
}

std::vector<Claim> joined(const Chapter& chapter, const std::vector<Trials>& trials) {
  std::map<std::string, const Trials*> by_id;
  for (const Trials& one : trials)
    if (!by_id.emplace(one.id, &one).second)
      throw std::logic_error("audit: two trials are called " + one.id);
  std::vector<Claim> claims;
  const Statement* without = nullptr;
  for (const Statement& statement : chapter.statements) {
    const auto found = by_id.find(statement.id);
    if (found == by_id.end()) {
      if (!without) without = &statement;
      continue;
    }
    const Trials& computed = *found->second;
    requireBoth(statement, "correction", !statement.corrected.empty(),
                static_cast<bool>(computed.corrected_trial));
    requireBoth(statement, "condition", !statement.condition.empty(),
                static_cast<bool>(computed.condition_trial));
    requireBoth(statement, "numbers_caption", !statement.numbers_caption.empty(),
                static_cast<bool>(computed.rows_of_numbers));
    requireBoth(statement, "numbers_head", !statement.numbers_head.empty(),
                static_cast<bool>(computed.rows_of_numbers));
    claims.push_back({statement, computed});
    by_id.erase(found);
  }
  std::string unsaid;  // a wrong id leaves one of each
  for (const auto& [id, one] : by_id) unsaid += (unsaid.empty() ? "" : ", ") + id;
  if (without)
    throw scene::InputError(without->where,
                            "statement \"" + without->id +
                                "\": crosscheck/audit/ computes no such statement, allowed: " +
                                (unsaid.empty() ? "none, each that it computes is there" : unsaid));
  if (!unsaid.empty())
    throw scene::InputError({chapter.file, 0},
                            "lacks statements that crosscheck/audit/ computes: " + unsaid);
  return claims;
}

int Audit::count(Holds holds) const {
  return static_cast<int>(std::count_if(entries.begin(), entries.end(),
                                        [&](const Entry& entry) { return entry.holds == holds; }));
}

bool Audit::isSound() const {
  return std::all_of(entries.begin(), entries.end(),
                     [](const Entry& entry) { return entry.isSound(); });
}

std::string Audit::headline() const {
  const auto counted = [&](bool equations, const char* one, const char* many) {
    int all = 0, of[3] = {};
    for (const Entry& entry : entries) {
      if (!entry.isPrinted() || entry.isEquation() != equations) continue;
      ++all;
      ++of[static_cast<int>(entry.holds)];
    }
    const auto n = [&](Holds holds) { return of[static_cast<int>(holds)]; };
    return fmt::format("{} {}: {} hold, {} under a condition, {} wrong", all, all == 1 ? one : many,
                       n(Holds::kTrue), n(Holds::kUnderCondition), n(Holds::kFalse));
  };
  const auto ours = std::count_if(entries.begin(), entries.end(),
                                  [](const Entry& entry) { return !entry.isPrinted(); });
  return counted(true, "equation", "equations") + "; " + counted(false, "sentence", "sentences") +
         fmt::format("; not counted: {} that the chapter leaves open or does not say", ours);
}

Audit runAudit(std::uint64_t seed, const std::function<bool(const Statement&)>& select) {
  Audit audit;
  audit.seed = seed;
  audit.chapter = bundledChapter();
  for (const Claim& claim : joined(audit.chapter, allTrials()))
    if (!select || select(claim.statement)) audit.entries.push_back(evaluate(claim, seed));
  return audit;
}

std::string plain(const std::string& text) {
  std::string out = text;
  out.erase(std::remove(out.begin(), out.end(), '`'), out.end());
  return out;
}

}  // namespace dynwitness::audit
