// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/examine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "crosscheck/diagnosis/exhibits.hpp"
#include "crosscheck/diagnosis/explain.hpp"
#include "crosscheck/diagnosis/smallest.hpp"
#include "crosscheck/diagnosis/textbook.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "scene/mimic.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using Judged = QuantityFound::Verdict;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kSingle = 0x1p29;  // roundings of float in those of double

bool isByRates(Quantity quantity) {
  return quantity == Quantity::kM || quantity == Quantity::kc || quantity == Quantity::kg ||
         quantity == Quantity::kTau || quantity == Quantity::kQdd;
}

/// What the exhibits of one quantity come to.
QuantityFound found(Quantity quantity, const std::vector<Exhibit>& exhibits) {
  QuantityFound out;
  out.quantity = quantity;
  bool wrong = false;
  for (const Exhibit& e : exhibits) {
    if (e.asked != quantity) continue;
    if (!e.failure.empty()) {
      if (out.reason.empty() && !e.is_impossible)
        out.reason = fmt::format("at state {}: {}", e.index, e.failure);
      continue;
    }
    ++out.states;
    wrong = wrong || e.is_wrong;
    if (e.size > 0) out.digits = std::min(out.digits.value_or(e.digits), e.digits);
    out.largest = std::max(out.largest, e.size);
    const double ulp = kEps * (e.size > 0 ? e.size : 1);
    for (Eigen::Index j = 0; j < e.error.cols(); ++j)
      for (Eigen::Index i = 0; i < e.error.rows(); ++i) {
        const double error = e.error(i, j), bound = e.bound(i, j);
        if (error > bound && isByRates(quantity) &&
            std::count(out.rates.begin(), out.rates.end(), static_cast<int>(i)) == 0)
          out.rates.push_back(static_cast<int>(i));
        const double ratio = error == 0  ? 0
                             : bound > 0 ? error / bound
                                         : std::numeric_limits<double>::infinity();
        if (!(ratio > out.ratio)) continue;
        out.ratio = ratio;
        out.seen = error / ulp;
        out.limit = bound / ulp;
        out.entry = entryName(crosscheck::name(quantity), i, j, e.error);
        out.state = e.index;
      }
  }
  std::sort(out.rates.begin(), out.rates.end());
  if (wrong)
    out.verdict = Judged::kWrong;
  else if (out.states > 0 && out.reason.empty())
    out.verdict = Judged::kRight;
  if (out.verdict == Judged::kWrong) out.reason.clear();
  return out;
}

/// The exhibit of tau at a chosen state, or nothing.
const Exhibit* exhibitAt(const std::vector<Exhibit>& exhibits, Quantity quantity, int index) {
  for (const Exhibit& e : exhibits)
    if (e.asked == quantity && e.index == index && e.failure.empty()) return &e;
  return nullptr;
}

bool exceeds(const Eigen::MatrixXd& error, const Eigen::MatrixXd& bound) {
  return (error.cwiseAbs().array() > bound.array()).any();
}

/// How errors grow: from the states that isolate terms.
void tellGrowth(const std::vector<Exhibit>& exhibits, Where& where) {
  const auto wrong = [&](const char* term, bool is_wrong, bool is_known = true) {
    where.terms.push_back(fmt::format("{}: {}", term,
                                      !is_known  ? "not told"
                                      : is_wrong ? "wrong"
                                                 : "right"));
  };
  const auto direct = [&](Quantity quantity) -> std::optional<bool> {
    std::optional<bool> out;
    for (const Exhibit& e : exhibits)
      if (e.asked == quantity && e.failure.empty()) out = out.value_or(false) || e.is_wrong;
    return out;
  };
  const Quantity kTau = Quantity::kTau;
  const Exhibit *still = exhibitAt(exhibits, kTau, kStill),
                *pushed = exhibitAt(exhibits, kTau, kPushed),
                *moving = exhibitAt(exhibits, kTau, kMoving),
                *backward = exhibitAt(exhibits, kTau, kBackward),
                *faster = exhibitAt(exhibits, kTau, kFaster);
  const bool has_tau = still && pushed && moving && backward && faster;
  const auto off = [](const Exhibit* e) { return Eigen::MatrixXd(e->said - e->truth); };
  bool tau_M = false, tau_g = false, tau_even = false, tau_odd = false;
  if (has_tau) {
    tau_g = exceeds(off(still), still->bound);
    tau_M = exceeds(off(pushed) - off(still), pushed->bound + still->bound);
    const Eigen::MatrixXd two = moving->bound + backward->bound;
    tau_even = exceeds(off(moving) + off(backward) - 2 * off(still), two + 2 * still->bound);
    tau_odd = exceeds(off(moving) - off(backward), two);
    if (tau_g) where.growth.emplace_back("tau is off at rest: in gravity, springs or loads");
    if (tau_M) where.growth.emplace_back("the error of tau grows with qdd: in M");
    if (tau_even) where.growth.emplace_back("the error of tau has a part that is even in qd: in c");
    if (tau_odd)
      where.growth.emplace_back("the error of tau has a part that is odd in qd: in friction");
    if (tau_even) {
      const Eigen::MatrixXd once = (off(moving) + off(backward)) / 2 - off(still);
      const Eigen::MatrixXd odd = (off(moving) - off(backward)) / 2;
      const Eigen::MatrixXd twice = off(faster) - off(still) - 2 * odd;
      if (!exceeds(twice - 4 * once, faster->bound + 4 * two + 8 * still->bound))
        where.growth.emplace_back("it grows with qd^2");
    }
  }
  const auto term = [&](const char* name, Quantity quantity, bool in_tau) {
    const std::optional<bool> own = direct(quantity);
    wrong(name, own.value_or(in_tau), own.has_value() || has_tau);
    if (own && has_tau && *own != in_tau)
      where.growth.push_back(fmt::format("{} is {} by itself and {} in tau", name,
                                         *own ? "wrong" : "right", in_tau ? "wrong" : "right"));
  };
  term("M", Quantity::kM, tau_M);
  term("c", Quantity::kc, tau_even);
  term("g", Quantity::kg, tau_g);
  if (has_tau) wrong("friction", tau_odd);
}

}  // namespace

const char* name(Judged verdict) {
  switch (verdict) {
    case Judged::kRight:
      return "right";
    case Judged::kWrong:
      return "wrong";
    case Judged::kCannotSay:
      return "cannot say";
  }
  return "";
}

bool Examination::isWrong() const {
  return !failure.empty() ||
         std::any_of(quantities.begin(), quantities.end(),
                     [](const QuantityFound& q) { return q.verdict == Judged::kWrong; });
}
bool Examination::isExplained() const {
  return !findings.empty() && findings.front().explains;
}

scene::Scene withoutFollowers(scene::Scene scene) {
  if (!scene.mechanism.hasMimics()) return scene;
  scene.mechanism = scene::withoutMimics(scene.mechanism);
  scene.start_qd.assign(static_cast<std::size_t>(scene.mechanism.dof()), scene::Number(0));
  return scene;
}

Examination examine(const scene::Scene& scene, const WitnessKind& kind,
                    const CheckOptions& options) {
  Examination out;
  out.scene = scene.name;
  out.engine = kind.info.name;
  out.version = kind.info.version;
  out.scalar = options.single ? "float" : "double";
  out.seed = options.seed;
  out.rate_labels = scene.mechanism.rateLabels();
  for (const scene::Link& link : scene.mechanism.links) {
    out.link_names.push_back(link.name);
    out.joint_names.push_back(link.parent < 0 ? "" : link.joint.name);
  }
  const double factor = options.single ? kSingle : 1;
  constexpr int kStages = 3;
  scene::Work work("check", kStages);

  MadeWitness made = kind.make(scene);
  if (made.isRefused()) throw scene::InputError({scene.file.string(), 0}, made.refusal());
  const std::unique_ptr<Witness> witness = std::move(made).value();
  const std::vector<scene::State<double>> chosen =
      chosenStates(scene.mechanism, scene.name, options.seed, options.single);
  out.states = static_cast<int>(chosen.size());
  if (auto* outside = dynamic_cast<OutsideWitness*>(witness.get())) {
    out.failure = outside->askedAhead(chosen);
    out.remarks = outside->remarks();
    if (!out.failure.empty()) return out;
  }
  work.done();

  std::vector<Exhibit> exhibits;
  Bench bench(scene, *witness, factor);
  for (const Quantity quantity : kAllQuantities) {
    if (quantity == Quantity::kReactions) continue;
    if (!witness->answers(quantity)) {
      QuantityFound missing;
      missing.quantity = quantity;
      missing.reason = "the engine does not know it";
      out.quantities.push_back(missing);
      continue;
    }
    for (int k = 0; k < out.states; ++k)
      if (isAskedAt(quantity, k))
        exhibits.push_back(bench.ask(quantity, chosen[static_cast<std::size_t>(k)], k));
    out.quantities.push_back(found(quantity, exhibits));
  }
  work.done();
  for (const QuantityFound& q : out.quantities)
    for (const int rate : q.rates)
      if (std::count(out.where.rates.begin(), out.where.rates.end(), rate) == 0)
        out.where.rates.push_back(rate);
  std::sort(out.where.rates.begin(), out.where.rates.end());
  if (!out.isWrong()) return out;

  tellGrowth(exhibits, out.where);
  if (options.explain) {
    const Explained explained_by = explained(textbookModel(scene), exhibits, chosen);
    out.findings = explained_by.findings;
    out.tried = explained_by.tried;
    out.pairs = explained_by.pairs;
    out.pairs_tried = explained_by.pairs_tried;
  }
  if (options.smallest && options.explain && !out.isExplained()) {
    const auto worst =
        std::find_if(exhibits.begin(), exhibits.end(), [](const Exhibit& e) { return e.is_wrong; });
    if (worst != exhibits.end())
      out.smallest = smallestFailure(scene, kind, worst->asked,
                                     chosen[static_cast<std::size_t>(worst->index)], factor);
  }
  return out;
}

}  // namespace dynwitness::crosscheck
