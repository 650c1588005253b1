// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/testimony.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Of M with unit diagonal, in double: far from where double can tell it from singular (2^52).
constexpr double kDoubtful = 0x1p40;

}  // namespace

Hearing::Hearing(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                 const Options& options)
    : scene_(scene), options_(options) {
  for (const WitnessKind& kind : kinds) witnesses_.push_back(makeWitness(kind, scene));
}

std::vector<CheckResult> Hearing::dismissRefused() {
  const auto refusal = [&](CheckKind kind, const Witness& witness, const std::string& statement,
                           const std::string& reason) {
    CheckResult check;
    check.kind = kind;
    check.statement = witness.name() + " " + statement;
    check.left = witness.name();
    check.seed = options_.seed;
    check.verdict = Verdict::kNotAnswerable;
    check.reason = reason;
    return check;
  };
  std::vector<CheckResult> refusals;
  std::vector<std::unique_ptr<Witness>> others;
  for (auto& witness : witnesses_) {
    const auto* refused = dynamic_cast<const RefusedWitness*>(witness.get());
    if (refused != nullptr) {
      refusals.push_back(
          refusal(CheckKind::kRefusal, *refused, "can hold the scene", refused->reason()));
      continue;
    }
    if (auto* outside = dynamic_cast<OutsideWitness*>(witness.get())) {
      std::vector<scene::State<double>> states;
      for (int k = 0; k < options_.states; ++k)
        states.push_back(drawState(scene_.mechanism, scene_.name, options_.seed, k));
      if (const std::string failure = outside->askedAhead(states); !failure.empty()) {
        refusals.push_back(refusal(CheckKind::kWitness, *outside, "testifies", failure));
        CheckResult& check = refusals.back();
        check.quantity = "testimony";
        check.states = 1;
        check.addVoided(0, failure, false);
        remarks_.emplace_back(outside->name(), failure);
        continue;
      }
      for (const std::string& remark : outside->remarks())
        remarks_.emplace_back(outside->name(), remark);
    }
    if (const auto* partial = dynamic_cast<const PartialWitness*>(witness.get()))
      for (const auto& [quantity, reason] : partial->leftOut()) {
        refusals.push_back(refusal(CheckKind::kWitness, *partial,
                                   fmt::format("answers {}", crosscheck::name(quantity)), reason));
        refusals.back().quantity = crosscheck::name(quantity);
      }
    others.push_back(std::move(witness));
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

void Hearing::putIntoEquations(const scene::State<double>& state, std::vector<Testimony>& said) {
  const bool asked = std::any_of(said.begin(), said.end(), [](const Testimony& one) {
    return one.failure.empty() && !one.residual && one.answer.residual_bound.size() > 0;
  });
  if (!asked) return;
  if (!backward_error_) backward_error_ = std::make_unique<BackwardError>(scene_.mechanism);
  backward_error_->at(state);
  const double condition = backward_error_->condition();
  // where M may be singular, whether it is: then nothing that anybody says means anything
  const bool doubtful =
      condition > kDoubtful || std::any_of(said.begin(), said.end(), [](const Testimony& one) {
        return one.failure.empty() && !one.answer.value.allFinite();
      });
  if (doubtful) {
    if (!truth_) truth_ = std::make_unique<Truth>(scene_.mechanism);
    if (const Certified exact = (*truth_)(Quantity::kQdd, state); exact.is_impossible) {
      for (Testimony& one : said) one.failure = "no certified truth: " + exact.reason;
      return;
    }
  }
  for (Testimony& one : said) {
    if (!one.failure.empty() || one.residual || one.answer.residual_bound.size() == 0) continue;
    one.residual = (*backward_error_)(one.answer.value);
    one.condition = condition;
  }
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
    if (quantity == Quantity::kQdd) putIntoEquations(state, said);
    listener(k, state, said);
  }
}

}  // namespace dynwitness::crosscheck
