// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/compared_answers.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <tuple>

#include <fmt/format.h>

namespace dynwitness::crosscheck::explaining {
namespace {

bool isForce(Quantity quantity) {
  return quantity == Quantity::kM || quantity == Quantity::kc || quantity == Quantity::kg ||
         quantity == Quantity::kTau || quantity == Quantity::kQdd;
}

/// The limits of a prediction, entry by entry.
MatrixXd limitOf(const Exhibit& exhibit, const MatrixXd& predicted, bool permuted) {
  const double truth = largest(exhibit.truth), here = largest(predicted);
  const double growth = truth > 0 ? std::max(1.0, here / truth) : 1.0;
  MatrixXd bound = exhibit.bound;
  if (permuted) bound.setConstant(largest(bound));
  return (2 * growth * bound).array() + kEps * std::max(here, truth);
}

bool isStale(const Belief& belief) {
  return belief.stale.q || belief.stale.qd || belief.stale.qdd;
}

/// Of these, what a belief can be asked about: nobody knows the question before the first.
bool isAnswerable(const Belief& belief, const Exhibit& e) {
  return !isStale(belief) || e.index > 0;
}

/// The largest of the terms that tau is the sum of.
double termsOf(const Textbook& textbook, const State& state) {
  return std::max({largest(textbook.inertial(state)), largest(textbook(Quantity::kc, state)),
                   largest(textbook(Quantity::kg, state))});
}

/// M qdd in place of M, with what the errors of M may make of it.
Exhibit productOf(const Exhibit& e) {
  const VectorXd qdd = Eigen::Map<const VectorXd>(e.state.qdd.data(), e.said.cols());
  const double n = static_cast<double>(qdd.size());
  Exhibit out = e;
  out.compared = Quantity::kTau;
  out.said = e.said * qdd;
  out.truth = e.truth * qdd;
  out.bound = (e.bound + n * kEps * e.truth.cwiseAbs()) * qdd.cwiseAbs();
  return out;
}
Misfit fromTruth(const Exhibit& e, const MatrixXd& predicted) {
  Exhibit own = e;
  own.said = e.truth;
  return misfitOf(own, predicted, false);
}

}  // namespace

Misfit misfitOf(const Exhibit& exhibit, const MatrixXd& predicted, bool permuted) {
  if (!predicted.allFinite()) return {std::numeric_limits<double>::infinity(), 0, 0};
  const MatrixXd off = (exhibit.said - predicted).cwiseAbs();
  const MatrixXd limit = limitOf(exhibit, predicted, permuted);
  Misfit out;
  for (Eigen::Index k = 0; k < off.size(); ++k)
    if (off.data()[k] > 0) out.share = std::max(out.share, off.data()[k] / limit.data()[k]);
  const double size =
      std::max(largest(predicted), exhibit.asked == Quantity::kQdd ? exhibit.size : 0);
  out.relative = size > 0 ? largest(off) / size : 0;
  out.ulp = out.relative / kEps;
  return out;
}

void keepWorse(Misfit& all, const Misfit& one) {
  all.share = std::max(all.share, one.share);
  all.ulp = std::max(all.ulp, one.ulp);
  all.relative = std::max(all.relative, one.relative);
}

Case::Case(const TextbookModel& model, const std::vector<Exhibit>& exhibits,
           const std::vector<State>& chosen, Scope scope)
    : chosen_(chosen) {
  right_.model = model;
  std::vector<Quantity> wrong;
  for (const Exhibit& e : exhibits) {
    if (e.is_wrong && std::count(wrong.begin(), wrong.end(), e.asked) == 0)
      wrong.push_back(e.asked);
    if (e.failure.empty() && e.asked != Quantity::kQdd)
      loose_[e.asked] = std::max(
          loose_[e.asked], largest(limitOf(e, e.truth, false)) / sizeOf(e.asked, e.truth, e.state));
  }
  const auto isWrong = [&](Quantity q) { return std::count(wrong.begin(), wrong.end(), q) > 0; };
  for (const Exhibit& e : exhibits) {
    if (!e.failure.empty()) continue;
    const bool counts = isWrong(e.asked) && (scope == Scope::kAll || isForce(e.asked));
    (counts ? primary_ : others_).push_back(&e);
  }
  // cheap and telling first: what needs one sweep, at a generic state that has one before it
  const auto cost = [](const Exhibit* e) {
    return std::make_tuple(!e->is_wrong, e->compared == Quantity::kM,
                           e->index == 0 ? kChosenStates : e->index);
  };
  std::stable_sort(primary_.begin(), primary_.end(),
                   [&](const Exhibit* a, const Exhibit* b) { return cost(a) < cost(b); });
  for (const Exhibit* e : primary_)
    if (std::none_of(heads_.begin(), heads_.end(),
                     [&](const Exhibit* h) { return h->asked == e->asked; }))
      heads_.push_back(e);
  const Textbook textbook(right_);
  for (const Exhibit* e : primary_) {
    const Misfit own = fromTruth(*e, textbook(e->compared, e->state));
    if (own.share > 1)
      throw std::logic_error(fmt::format(
          "diagnosis: the textbook's {} is {} limits from the certified truth, at "
          "state {}, where {} was asked",
          crosscheck::name(e->compared), own.share, e->index, crosscheck::name(e->asked)));
  }
}

MatrixXd Case::predicted(const Textbook& textbook, const Belief& belief, const Exhibit& e) const {
  const bool solved = e.asked == Quantity::kQdd;
  if (!isStale(belief)) return textbook(e.compared, e.state, solved);
  return textbook(e.compared, mixed(belief, e), solved);
}

MatrixXd Case::glanced(const Textbook& textbook, const Belief& belief, const Exhibit& e) const {
  if (e.compared != Quantity::kM) return predicted(textbook, belief, e);
  State state = isStale(belief) ? mixed(belief, e) : e.state;
  state.qdd = e.state.qdd;
  return textbook.inertial(state);
}

std::optional<Misfit> Case::whole(const Belief& belief) const {
  const Textbook textbook(belief);
  const bool permuted = !belief.passing.order.empty();
  Misfit all;
  bool looked = false, differs = false;
  for (const Exhibit* e : primary_) {
    if (!isAnswerable(belief, *e)) continue;
    differs = differs || e->is_wrong;
    if (e->compared == Quantity::kM && !looked) {
      looked = true;
      const Exhibit product = productOf(*e);
      if (!(misfitOf(product, glanced(textbook, belief, *e), permuted).share <= 1)) return {};
    }
    const Misfit one = misfitHere(textbook, belief, *e, predicted(textbook, belief, *e));
    if (!(one.share <= 1)) return {};
    keepWorse(all, one);
  }
  if (!differs) return {};
  return all;
}

void Case::compareOthers(const Belief& belief, CheckFinding& finding) const {
  const Textbook textbook(belief);
  for (const Exhibit* e : others_) {
    if (!isAnswerable(belief, *e)) continue;
    const Misfit one = misfitHere(textbook, belief, *e, predicted(textbook, belief, *e));
    if (one.share <= 1) continue;
    const std::string quantity = crosscheck::name(e->asked);
    std::vector<std::string>& list = e->is_wrong ? finding.unasked : finding.spared;
    if (std::count(list.begin(), list.end(), quantity) == 0) list.push_back(quantity);
  }
  // wrong somewhere and right elsewhere is wrong
  for (const std::string& quantity : finding.unasked)
    finding.spared.erase(std::remove(finding.spared.begin(), finding.spared.end(), quantity),
                         finding.spared.end());
}

bool Case::areOne(const Belief& one, const Belief& other) const {
  if (isStale(one) || isStale(other)) return false;
  const Textbook a(one), b(other);
  for (std::size_t k = 0; k < kGeneric + 3; ++k) {
    State state = chosen_[k];
    state.qd = chosen_[(k + 1) % 3].qd;
    state.qdd = chosen_[(k + 2) % 3].qdd;
    for (const auto& [quantity, limit] : loose_) {
      const MatrixXd of_a = a(quantity, state), of_b = b(quantity, state);
      if (!of_a.allFinite() || !of_b.allFinite()) return false;
      const double size = std::max({largest(of_a), largest(of_b), sizeOf(quantity, of_a, state)});
      if (!(largest(of_a - of_b) <= 2 * limit * size)) return false;
    }
  }
  return true;
}

VectorXd Case::stacked(const std::vector<const Exhibit*>& exhibits, const Belief& belief,
                       bool predicted_alone, bool glance) const {
  const Textbook textbook(belief);
  std::vector<double> out;
  for (const Exhibit* e : exhibits) {
    const Exhibit product = glance && e->compared == Quantity::kM ? productOf(*e) : Exhibit();
    const Exhibit& here = glance && e->compared == Quantity::kM ? product : *e;
    const MatrixXd told = !isAnswerable(belief, *e) ? here.said
                          : glance                  ? glanced(textbook, belief, *e)
                                                    : predicted(textbook, belief, *e);
    const MatrixXd limit = limitOf(here, here.truth, false);
    for (Eigen::Index k = 0; k < told.size(); ++k) {
      const double l = limit.data()[k];
      const double value = predicted_alone ? told.data()[k] : here.said.data()[k] - told.data()[k];
      out.push_back(l > 0 ? value / l : 0);
    }
  }
  return Eigen::Map<const VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

State Case::mixed(const Belief& belief, const Exhibit& e) const {
  const State& before = chosen_[static_cast<std::size_t>(e.index) - 1];
  State out = e.state;
  if (belief.stale.q) out.x = before.x;
  if (belief.stale.qd) out.qd = before.qd;
  if (belief.stale.qdd && e.asked != Quantity::kQdd) out.qdd = before.qdd;
  return out;
}

double Case::sizeOf(Quantity quantity, const MatrixXd& value, const State& state) const {
  double size = largest(value);
  if (isForce(quantity) && quantity != Quantity::kM && state.qdd.size() == state.qd.size())
    size = std::max(size, termsOf(Textbook(right_), state));
  return size > 0 ? size : 1;
}

Misfit Case::misfitHere(const Textbook& textbook, const Belief& belief, const Exhibit& e,
                        const MatrixXd& told) const {
  const bool permuted = !belief.passing.order.empty();
  const Misfit plain = misfitOf(e, told, permuted);
  constexpr double kNoRounding = 1e6;  // limits
  if (e.compared != Quantity::kTau || !(plain.share > 1) || !(plain.share < kNoRounding))
    return plain;
  const State state = isStale(belief) ? mixed(belief, e) : e.state;
  const double before = termsOf(Textbook(right_), e.state), here = termsOf(textbook, state);
  Exhibit more = e;
  if (before > 0) more.bound *= std::max(1.0, here / before);
  return misfitOf(more, told, permuted);
}

}  // namespace dynwitness::crosscheck::explaining
