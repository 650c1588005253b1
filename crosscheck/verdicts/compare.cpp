// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/compare.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/verdicts/testimony.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"

namespace dynwitness::crosscheck {
namespace {

/// M (x - y) of two answers qdd, in the equations: within what both may leave of these.
void compareResiduals(int index, const Testimony& x, const Testimony& y, const std::string& excuse,
                      Tally& tally) {
  if (!excuse.empty())
    return tally.fail(index, excuse, excuse);  // M is singular: nothing is the same
  const MatrixX<Ball> difference = x.residual->value - y.residual->value;
  // what is proven of it; of an answer that is no number, nothing is
  const Eigen::MatrixXd at_least = difference.unaryExpr([](const Ball& ball) {
    return ball.isFinite() ? ball.atLeast() : std::numeric_limits<double>::infinity();
  });
  tally.addDifference(index, at_least, x.answer.residual_bound + y.answer.residual_bound,
                      std::max(x.residual->size, y.residual->size));
  tally.addCondition(x.condition);
}

}  // namespace

PairComparison::PairComparison(Quantity quantity, std::vector<std::string> witnesses,
                               const Options& options, bool with_control) {
  if (with_control) witnesses.emplace_back(kControl);
  for (std::size_t a = 0; a < witnesses.size(); ++a) {
    for (std::size_t b = a + 1; b < witnesses.size(); ++b) {
      CheckResult check = sameInWords(name(quantity), witnesses[a], witnesses[b]);
      check.right_is_control = with_control && b + 1 == witnesses.size();
      if (quantity == Quantity::kQdd)
        check.statement =
            fmt::format("M (qdd by {} - qdd by {}) = 0, in forces", check.left, check.right);
      check.seed = options.seed;
      tallies_.emplace_back(check);
    }
  }
}

void PairComparison::add(int index, const std::vector<Testimony>& said, const std::string& excuse) {
  std::size_t pair = 0;
  for (std::size_t a = 0; a < said.size(); ++a) {
    for (std::size_t b = a + 1; b < said.size(); ++b, ++pair) {
      const Testimony& failed = said[a].failure.empty() ? said[b] : said[a];
      if (!failed.failure.empty())
        tallies_[pair].fail(index, fmt::format("{}: {}", failed.witness, failed.failure), excuse);
      else if (said[a].residual && said[b].residual)
        compareResiduals(index, said[a], said[b], excuse, tallies_[pair]);
      else
        tallies_[pair].add(index, said[a].answer.value, said[b].answer.value,
                           said[a].answer.bound + said[b].answer.bound, excuse);
    }
  }
}

std::vector<CheckResult> PairComparison::results() const {
  std::vector<CheckResult> results;
  for (const Tally& tally : tallies_) results.push_back(tally.result());
  return results;
}

std::vector<CheckResult> compareWitnesses(const PreparedScene& scene,
                                          const std::vector<WitnessKind>& kinds,
                                          const Options& options) {
  Hearing hearing(scene, kinds, options);
  std::vector<CheckResult> results;
  for (const Quantity quantity : kAllQuantities) {
    PairComparison pairs(quantity, hearing.answering(quantity), options);
    hearing.hear(quantity, [&](int index, const scene::State<double>&,
                               const std::vector<Testimony>& said) { pairs.add(index, said); });
    for (CheckResult& check : pairs.results()) results.push_back(std::move(check));
  }
  return results;
}

namespace {

/// Witnesses whose answers of this quantity are not within their bounds of the certified truth.
std::vector<std::string> offTheTruth(const std::string& quantity,
                                     const std::vector<CheckResult>& checks) {
  std::vector<std::string> off;
  for (const CheckResult& check : checks)
    if (check.kind == CheckKind::kTruth && check.quantity == quantity &&
        check.verdict == Verdict::kDisagree)
      off.push_back(check.left);
  return off;
}

}  // namespace

std::vector<Finding> findOutliers(const std::string& scene_name,
                                  const std::vector<CheckResult>& checks) {
  std::vector<std::string> quantities;  // in dispute, in order
  for (const CheckResult& check : checks)
    if ((check.kind == CheckKind::kSame || check.kind == CheckKind::kTruth) &&
        check.verdict == Verdict::kDisagree &&
        std::count(quantities.begin(), quantities.end(), check.quantity) == 0)
      quantities.push_back(check.quantity);

  std::vector<Finding> findings;
  for (const std::string& quantity : quantities) {
    std::map<std::string, int> disputes, pairs;  // by witness
    int disputed = 0, agreed = 0;
    for (const CheckResult& check : checks) {
      if (check.kind != CheckKind::kSame || check.quantity != quantity ||
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
    Finding finding;
    finding.scene = scene_name;
    finding.quantity = quantity;
    finding.witness = outlier.value_or("");
    // pairs have the sum of two limits: the truth condemns where they do not, and decides
    // between two
    if (const std::vector<std::string> off = offTheTruth(quantity, checks);
        !outlier && !off.empty()) {
      if (off.size() == 1) finding.witness = off.front();
      finding.text = fmt::format("{}: {}: {} {} off the certified truth", scene_name, quantity,
                                 fmt::join(off, ", "), off.size() == 1 ? "alone is" : "are");
      findings.push_back(finding);
      continue;
    }
    finding.text = outlier ? fmt::format("{}: {}: {} stands alone; {} agree with each other",
                                         scene_name, quantity, *outlier, others)
                           : fmt::format("{}: {}: {} disagree, and no single one stands alone",
                                         scene_name, quantity, others);
    findings.push_back(finding);
  }
  return findings;
}

}  // namespace dynwitness::crosscheck
