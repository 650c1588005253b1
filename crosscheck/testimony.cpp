// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/testimony.hpp"

#include <fmt/format.h>

#include "crosscheck/states.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"

namespace dynwitness::crosscheck {

Hearing::Hearing(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                 const Options& options)
    : scene_(scene), options_(options) {
  for (const WitnessKind& kind : kinds) witnesses_.push_back(makeWitness(kind, scene));
}

std::vector<CheckResult> Hearing::dismissRefused() {
  std::vector<CheckResult> refusals;
  std::vector<std::unique_ptr<Witness>> others;
  for (auto& witness : witnesses_) {
    const auto* refused = dynamic_cast<const RefusedWitness*>(witness.get());
    if (refused == nullptr) {
      others.push_back(std::move(witness));
      continue;
    }
    CheckResult check;
    check.check = "witness";
    check.statement = fmt::format("{} can hold the scene", refused->name());
    check.left = refused->name();
    check.seed = options_.seed;
    check.verdict = Verdict::kNotAnswerable;
    check.reason = refused->reason();
    refusals.push_back(check);
  }
  witnesses_ = std::move(others);
  return refusals;
}

std::vector<std::string> Hearing::answering(Quantity quantity) const {
  std::vector<std::string> names;
  for (const auto& witness : witnesses_)
    if (witness->answers(quantity)) names.push_back(witness->name());
  return names;
}

void Hearing::hear(Quantity quantity, const Listener& listener) {
  for (int k = 0; k < options_.states; ++k) {
    const scene::State<double> state = drawState(scene_.mechanism, scene_.name, options_.seed, k);
    std::vector<Testimony> said;
    for (const auto& witness : witnesses_) {
      if (!witness->answers(quantity)) continue;
      said.push_back({witness->name(), {}, {}});
      try {
        said.back().answer = witness->answer(quantity, state);
      } catch (const std::exception& error) {
        said.back().failure = error.what();
      }
    }
    listener(k, state, said);
  }
}

}  // namespace dynwitness::crosscheck
