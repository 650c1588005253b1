// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/testimony.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/verdicts/claims.hpp"
#include "crosscheck/witnesses/coupled.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Of M with unit diagonal, in double: far from where double can tell it from singular (2^52).
constexpr double kDoubtful = 0x1p40;

}  // namespace

Hearing::Hearing(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                 const Options& options)
    : scene_(scene), options_(options) {
  for (const WitnessKind& kind : kinds) {
    MadeWitness made = kind.make(scene);
    const std::string name = made.isRefused() ? kind.info.name : (*made)->name();
    seats_.push_back({name, std::move(made)});
  }
}

/// One that has refused is asked everything, and says why not.
bool Hearing::Seat::isAsked(Quantity quantity) const {
  return witness.isRefused() || (*witness)->answers(quantity);
}

scene::State<double> Hearing::drawn(int index) const {
  return drawState(scene_.mechanism(), scene_.scene().name, options_.seed, index);
}

/// What it says besides quantities, with what it says wrongly as remarks: those come first, since a
/// model that differs explains what follows from it.
std::vector<CheckResult> Hearing::claimsOf(OutsideClaims& claims, const std::string& witness,
                                           const PreparedScene& scene,
                                           const std::vector<scene::State<double>>& states) {
  std::vector<CheckResult> checks;
  try {
    checks = judgeClaims(claims, witness, scene, states);
  } catch (const std::runtime_error& failure) {
    remarks_.emplace_back(witness, failure.what());  // and so will every quantity say
    return {};
  }
  for (CheckResult& check : checks) {
    check.seed = options_.seed;
    if (check.verdict == Verdict::kDisagree)
      remarks_.emplace_back(witness, fmt::format("{}: {}: {}", witness, check.law, check.reason));
  }
  return checks;
}

std::vector<CheckResult> Hearing::dismissRefused() {
  const auto refusal = [&](CheckKind kind, const std::string& witness, const std::string& statement,
                           const std::string& reason) {
    CheckResult check;
    check.kind = kind;
    check.statement = witness + " " + statement;
    check.left = witness;
    check.seed = options_.seed;
    check.verdict = Verdict::kNotAnswerable;
    check.reason = reason;
    return check;
  };
  std::vector<CheckResult> refusals;
  std::vector<Seat> others;
  for (Seat& seat : seats_) {
    if (seat.witness.isRefused()) {
      refusals.push_back(
          refusal(CheckKind::kRefusal, seat.name, "can hold the scene", seat.witness.refusal()));
      continue;
    }
    Witness* const witness = (*seat.witness).get();
    // where joints follow others, a program knows the tree alone, and is heard about that
    const auto* const over = dynamic_cast<const OverTree*>(witness);
    Witness* const asked = over ? &over->ofTree() : witness;
    auto* const outside = dynamic_cast<OutsideWitness*>(asked);
    auto* const claims = dynamic_cast<OutsideClaims*>(asked);
    std::vector<scene::State<double>> states;
    for (int k = 0; (outside || claims) && k < options_.states; ++k)
      states.push_back(over ? over->onTree(drawn(k)) : drawn(k));
    if (outside)
      if (const std::string failure = outside->askedAhead(states); !failure.empty()) {
        refusals.push_back(refusal(CheckKind::kWitness, seat.name, "testifies", failure));
        CheckResult& check = refusals.back();
        check.quantity = "testimony";
        check.states = 1;
        check.addVoided(0, failure, false);
        remarks_.emplace_back(seat.name, failure);
        continue;
      }
    if (claims)
      for (CheckResult& check : claimsOf(*claims, seat.name, over ? scene_.tree() : scene_, states))
        refusals.push_back(std::move(check));
    if (outside)
      for (const std::string& remark : outside->remarks()) remarks_.emplace_back(seat.name, remark);
    if (const auto* partial = dynamic_cast<const PartialWitness*>(witness))
      for (const auto& [quantity, reason] : partial->leftOut()) {
        refusals.push_back(refusal(CheckKind::kWitness, seat.name,
                                   fmt::format("answers {}", crosscheck::name(quantity)), reason));
        refusals.back().quantity = crosscheck::name(quantity);
      }
    others.push_back(std::move(seat));
  }
  seats_ = std::move(others);
  return refusals;
}

std::vector<std::string> Hearing::answering(Quantity quantity) const {
  std::vector<std::string> names;
  for (const Seat& seat : seats_)
    if (seat.isAsked(quantity)) names.push_back(seat.name);
  return names;
}

void Hearing::putIntoEquations(const scene::State<double>& state, std::vector<Testimony>& said) {
  const bool asked = std::any_of(said.begin(), said.end(), [](const Testimony& one) {
    return one.failure.empty() && !one.residual && one.answer.residual_bound.size() > 0;
  });
  if (!asked) return;
  if (!backward_error_) backward_error_ = std::make_unique<BackwardError>(scene_);
  backward_error_->at(state);
  const double condition = backward_error_->condition();
  // where M may be singular, whether it is: then nothing that anybody says means anything
  const bool doubtful =
      condition > kDoubtful || std::any_of(said.begin(), said.end(), [](const Testimony& one) {
        return one.failure.empty() && !one.answer.value.allFinite();
      });
  if (doubtful) {
    if (!truth_) truth_ = std::make_unique<Truth>(scene_.mechanism());
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
    const scene::State<double> state = drawn(k);
    std::vector<Testimony> said;
    for (const Seat& seat : seats_) {
      if (!seat.isAsked(quantity)) continue;
      said.push_back({seat.name, {}, {}});
      if (seat.witness.isRefused()) {
        said.back().failure = seat.witness.refusal();
        continue;
      }
      try {
        said.back().answer = (*seat.witness)->answer(quantity, state);
      } catch (const std::exception& error) {
        said.back().failure = error.what();
      }
    }
    if (quantity == Quantity::kQdd) putIntoEquations(state, said);
    listener(k, state, said);
  }
}

}  // namespace dynwitness::crosscheck
