// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/explain.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/diagnosis/compared_answers.hpp"
#include "crosscheck/diagnosis/found_mistakes.hpp"
#include "crosscheck/diagnosis/hypotheses.hpp"
#include "crosscheck/diagnosis/mistake_pairs.hpp"
#include "crosscheck/diagnosis/single_mistakes.hpp"
#include "crosscheck/diagnosis/suspects.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace explaining {
namespace {

/// The best first; of findings of the same rule at the same place the first; and which of them
/// nobody can tell from the first.
std::vector<CheckFinding> inOrder(const Case& all, std::vector<Found> found) {
  const auto rank = [](const Found& f) {
    return std::make_pair(f.finding.unasked.size(), f.finding.spared.size());
  };
  std::stable_sort(found.begin(), found.end(),
                   [&](const Found& a, const Found& b) { return rank(a) < rank(b); });
  const auto key = [](const CheckFinding& f) {
    std::string out;
    for (const Explanation& part : f.parts)
      out += fmt::format("{} {} {};", part.rule, part.link, part.at_joint);
    return out;
  };
  std::vector<CheckFinding> kept;
  for (Found& f : found) {
    if (std::any_of(kept.begin(), kept.end(),
                    [&](const CheckFinding& k) { return key(k) == key(f.finding); }))
      continue;
    if (!kept.empty())
      f.finding.is_first = rank(f) == rank(found.front()) &&
                           f.finding.spared == found.front().finding.spared &&
                           all.areOne(f.belief, found.front().belief);
    kept.push_back(f.finding);
  }
  return kept;
}

/// Whether it leaves nothing to be explained, and takes nothing for wrong that is right.
bool isClean(const Search& search) {
  return std::any_of(search.found.begin(), search.found.end(), [](const Found& f) {
    return f.finding.unasked.empty() && f.finding.spared.empty();
  });
}

}  // namespace
}  // namespace explaining

Explained explained(const TextbookModel& model, const std::vector<Exhibit>& given,
                    const std::vector<scene::State<double>>& chosen) {
  using namespace explaining;
  Explained out;
  const bool rounded = isRounded(given);
  std::vector<Exhibit> exhibits = given, coarse;  // coarse: with the limits of single precision
  for (Exhibit& e : exhibits) {
    coarse.push_back(e);
    coarse.back().bound = kSingle * e.sweep_bound;
    coarse.back().is_wrong = (e.error.array() > kSingle * e.bound.array()).any();
    e.bound = e.sweep_bound;
  }
  const std::vector<Hypothesis> list = hypotheses(model);
  const std::vector<Suspect> numbers = suspects(model);
  const scene::Work work("hypotheses", 4);
  Search search;
  std::size_t looked_at = 0;
  for (const Scope scope : {Scope::kAll, Scope::kForces}) {
    const Case all(model, exhibits, chosen, scope);
    if (all.primary().empty() || all.primary().size() == looked_at) continue;
    looked_at = all.primary().size();
    // so near to the limit that no mistake at all explains it as well as any
    if (all.whole(all.right())) continue;
    addSingles(all, list, search);
    if (!isClean(search)) addEstimates(all, numbers, search);
    if (search.found.empty()) addSingle(all, rounded, search);
    const auto addBesideSingle = [&] {  // something else, and single precision
      const Case in_single(model, coarse, chosen, scope);
      if (in_single.primary().empty()) return;
      addSingles(in_single, list, search);
      if (search.found.empty()) addEstimates(in_single, numbers, search);
      std::vector<Found>& found = search.found;
      found.erase(std::remove_if(found.begin(), found.end(),
                                 [&](const Found& f) {
                                   return !isOfSingle(f.finding.residual_relative, rounded);
                                 }),
                  found.end());
      for (Found& f : found) f.finding.parts.push_back(singlePrecision(rounded));
    };
    if (search.found.empty() && rounded) addBesideSingle();
    if (search.found.empty()) {
      std::vector<CheckFinding> nearest = addPairs(all, list, numbers, search);
      if (search.found.empty()) out.findings = std::move(nearest);
    }
    if (search.found.empty()) continue;
    out.findings = inOrder(all, std::move(search.found));
    break;
  }
  out.tried = search.tried;
  out.pairs = search.pairs;
  out.pairs_tried = search.pairs_tried;
  return out;
}

}  // namespace dynwitness::crosscheck
