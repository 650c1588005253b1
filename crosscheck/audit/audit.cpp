// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/audit/audit.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

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

/// "eq" and digits
bool isNumbered(const std::string& id) {
  return id.size() > 2 && id.compare(0, 2, "eq") == 0 &&
         std::all_of(id.begin() + 2, id.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// "7.1.2" as numbers, for the order of the chapter.
std::vector<int> sectionNumbers(const std::string& section) {
  std::vector<int> numbers(1, 0);
  for (const char c : section) {
    if (c == '.')
      numbers.push_back(0);
    else
      numbers.back() = 10 * numbers.back() + (c - '0');
  }
  return numbers;
}

}  // namespace

bool Entry::isSound() const {
  if (residual_corrected && !residual_corrected->zero) return false;
  if (residual_condition && !residual_condition->zero) return false;
  return holds == Holds::kTrue || residual_corrected.has_value();
}

Entry evaluate(const Claim& claim, std::uint64_t seed) {
  if (!claim.printed_trial) throw std::logic_error(claim.id + ": nothing to compute");
  Entry entry;
  entry.id = claim.id;
  entry.section = claim.section;
  entry.title = claim.title;
  entry.kind = claim.is_open ? "open item" : isNumbered(claim.id) ? "equation" : "sentence";
  entry.printed = claim.printed_text;
  entry.corrected = claim.corrected_text;
  entry.condition = claim.condition_text;
  entry.why = claim.why_text;
  entry.implemented_in = claim.implemented_in;
  const std::string name = "audit " + claim.id;
  entry.residual_printed = claim.printed_trial(name, seed);
  if (claim.corrected_trial) entry.residual_corrected = claim.corrected_trial(name, seed);
  if (claim.condition_trial) entry.residual_condition = claim.condition_trial(name, seed);
  if (claim.table_of_numbers) entry.numbers = claim.table_of_numbers();
  if (entry.residual_printed.zero)
    entry.holds = Holds::kTrue;
  else if (entry.residual_condition && entry.residual_condition->zero)
    entry.holds = Holds::kUnderCondition;
  return entry;
}

std::vector<Claim> allClaims() {
  std::vector<Claim> all;
  for (const auto& group : {frames, rigidBody, projections, recursions, algorithms,
                            constrainedSystems, constraints, analytical, lagrange, geometry}) {
    std::vector<Claim> claims = group();
    std::move(claims.begin(), claims.end(), std::back_inserter(all));
  }
  std::stable_sort(all.begin(), all.end(), [](const Claim& a, const Claim& b) {
    return sectionNumbers(a.section) < sectionNumbers(b.section);
  });
  return all;
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
  // "74 equations: 51 hold, 10 under a condition, 13 wrong"
  const auto counted = [&](bool equations, const char* one, const char* many) {
    int all = 0, of[3] = {};
    for (const Entry& entry : entries) {
      if (entry.isEquation() != equations) continue;
      ++all;
      ++of[static_cast<int>(entry.holds)];
    }
    const auto n = [&](Holds holds) { return of[static_cast<int>(holds)]; };
    return fmt::format("{} {}: {} hold, {} under a condition, {} wrong", all, all == 1 ? one : many,
                       n(Holds::kTrue), n(Holds::kUnderCondition), n(Holds::kFalse));
  };
  return counted(true, "equation", "equations") + "; " +
         counted(false, "sentence or open item", "sentences and open items");
}

Audit runAudit(std::uint64_t seed, const std::function<bool(const Claim&)>& select) {
  Audit audit;
  audit.seed = seed;
  for (const Claim& claim : allClaims())
    if (!select || select(claim)) audit.entries.push_back(evaluate(claim, seed));
  return audit;
}

std::string plain(const std::string& text) {
  std::string out = text;
  out.erase(std::remove(out.begin(), out.end(), '`'), out.end());
  return out;
}

}  // namespace dynwitness::audit
