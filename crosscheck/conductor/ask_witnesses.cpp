// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/conductor/ask_witnesses.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "crosscheck/verdicts/control.hpp"
#include "crosscheck/verdicts/testimony.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
void append(std::vector<CheckResult>& all, std::vector<CheckResult> more) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

DigitsFound askWitnesses(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                         const Options& options, std::vector<CheckResult>& checks,
                         std::vector<Control>& controls) {
  Hearing hearing(scene, kinds, options);
  append(checks, hearing.dismissRefused());
  DigitsCount count(scene, options);
  ControlWitness control(scene, options);
  const auto costOf = [&](Quantity q) { return q == Quantity::kM ? scene.mechanism().dof() : 1; };
  double units = 0;
  for (const Quantity quantity : kAllQuantities) units += costOf(quantity) * options.states;
  scene::Work work("pairs of witnesses", units);
  for (const Quantity quantity : kAllQuantities) {
    const std::vector<std::string> names = hearing.answering(quantity);
    PairComparison pairs(quantity, names, options);
    PairComparison pairs_of_control(quantity, names, options, true);
    hearing.hear(quantity, [&](int index, const scene::State<double>& state,
                               const std::vector<Testimony>& said) {
      const Certified exact = count.truth(quantity, state);
      const std::string excuse = exact.is_impossible ? exact.reason : "";
      pairs.add(index, said, excuse);
      std::vector<Testimony> all = said;
      if (control.joins(quantity, index, state, exact, all)) {
        if (quantity == Quantity::kQdd) hearing.putIntoEquations(state, all);
        pairs_of_control.add(index, all, excuse);
      }
      count.add(quantity, index, state, all, exact);
      work.done(costOf(quantity));
    });
    append(checks, pairs.results());
    control.judgedInPairs(pairs_of_control.results());
  }
  DigitsFound truth = count.found();
  control.takeFrom(truth);
  controls = control.results();
  // a limit that contains a loss says so, in the pairs as well
  for (const CheckResult& lossy : truth.checks)
    for (CheckResult& pair : checks)
      if (lossy.known_loss && pair.quantity == lossy.quantity &&
          (pair.left == lossy.left || pair.right == lossy.left))
        pair.known_loss = true;
  for (const auto& [witness, remark] : hearing.remarks()) {
    Finding finding;
    finding.kind = Finding::Kind::kEngine;
    finding.scene = scene.scene().name;
    finding.quantity = "testimony";
    finding.witness = witness;
    finding.text = fmt::format("{}: {}", finding.scene, remark);
    truth.losses.push_back(finding);
  }
  return truth;
}

}  // namespace dynwitness::crosscheck
