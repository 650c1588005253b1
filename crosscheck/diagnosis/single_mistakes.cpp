// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/single_mistakes.hpp"

#include <limits>
#include <optional>

#include "crosscheck/diagnosis/estimated_number.hpp"

namespace dynwitness::crosscheck::explaining {

void addSingles(const Case& all, const std::vector<Hypothesis>& list, Search& out) {
  for (const Hypothesis& h : list) {
    Belief belief = all.right();
    h.apply(belief);
    ++out.tried;
    if (const auto misfit = all.whole(belief))
      out.found.push_back(findingOf(all, belief, {wordsOf(h)}, *misfit));
  }
}

void addEstimates(const Case& all, const std::vector<Suspect>& list, Search& out) {
  std::vector<const Exhibit*> some;  // generic states are enough to estimate from
  for (const Exhibit* e : all.primary())
    if (e->index < kStill || e->index == kFaster) some.push_back(e);
  if (some.empty()) some = all.primary();
  for (const Suspect& suspect : list) {
    ++out.tried;
    VectorXd uncertainty;
    if (suspect.names.size() == 1 &&
        !estimated(all, {all.heads().front()}, all.right(), suspect, &uncertainty, true))
      continue;
    const auto added = estimated(all, some, all.right(), suspect, &uncertainty);
    if (!added) continue;
    Belief belief = all.right();
    suspect.apply(belief, *added);
    if (const auto misfit = all.whole(belief))
      out.found.push_back(findingOf(all, belief, {wordsOf(suspect, *added, uncertainty)}, *misfit));
  }
}

bool isRounded(const std::vector<Exhibit>& exhibits) {
  for (const Exhibit& e : exhibits)
    for (Eigen::Index k = 0; k < e.said.size() && e.failure.empty(); ++k) {
      const double x = e.said.data()[k];
      if (e.asked != Quantity::kQdd && static_cast<double>(static_cast<float>(x)) != x)
        return false;
    }
  return true;
}

bool isOfSingle(double relative, bool rounded) {
  return rounded || relative >= std::numeric_limits<float>::epsilon() / 4;
}

Explanation singlePrecision(bool rounded) {
  return {"float_precision",
          -1,
          false,
          rounded ? "single precision (float): all numbers have 24 bits"
                  : "single precision (float) somewhere: errors of its size",
          {}};
}

void addSingle(const Case& all, bool rounded, Search& out) {
  Misfit worst;
  for (const Exhibit* e : all.primary()) {
    Misfit one = misfitOf(*e, e->truth, false);
    one.share /= kSingle;
    keepWorse(worst, one);
  }
  ++out.tried;
  if (worst.share > 1 || !isOfSingle(worst.relative, rounded)) return;
  out.found.push_back(findingOf(all, all.right(), {singlePrecision(rounded)}, worst));
}

}  // namespace dynwitness::crosscheck::explaining
