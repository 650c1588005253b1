// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/examine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/diagnosis/exhibits.hpp"
#include "crosscheck/diagnosis/explain.hpp"
#include "crosscheck/diagnosis/smallest.hpp"
#include "crosscheck/diagnosis/textbook.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/witnesses/column_names.hpp"
#include "crosscheck/witnesses/optional_engine.hpp"
#include "scene/mimic.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using Judged = QuantityFound::Verdict;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kSingle = 0x1p29;  // roundings of float in those of double
constexpr double kTiniest = std::numeric_limits<double>::min();

bool isByRates(Quantity quantity) {
  return quantity == Quantity::kM || quantity == Quantity::kc || quantity == Quantity::kg ||
         quantity == Quantity::kTau || quantity == Quantity::kQdd;
}

/// What the exhibits of one quantity come to.
/// @param entries  names of its entries where they have any: "elbow.fx"
QuantityFound found(const std::string& name, Quantity quantity, bool by_rates,
                    const std::vector<Exhibit>& exhibits,
                    const std::vector<std::string>& entries = {}) {
  QuantityFound out;
  out.name = name;
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
        if (error > bound && by_rates &&
            std::count(out.rates.begin(), out.rates.end(), static_cast<int>(i)) == 0)
          out.rates.push_back(static_cast<int>(i));
        const double ratio = error == 0  ? 0
                             : bound > 0 ? error / bound
                                         : std::numeric_limits<double>::infinity();
        if (!(ratio > out.ratio)) continue;
        out.ratio = ratio;
        out.seen = error / ulp;
        out.limit = bound / ulp;
        out.entry = entries.empty() ? entryName(name, i, j, e.error)
                                    : entries.at(static_cast<std::size_t>(i));
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

/// Why a witness of whom nothing is known to be wrong is not right.
std::string nothingJudged(const Examination& examined) {
  std::string reasons;
  for (const QuantityFound& q : examined.quantities)
    reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", q.name, q.reason);
  return "nothing that it says could be judged: " + reasons;
}

/// The exhibit of tau at a state, or nothing.
const Exhibit* exhibitAt(const std::vector<Exhibit>& exhibits, Quantity quantity, int index) {
  for (const Exhibit& e : exhibits)
    if (e.asked == quantity && e.index == index && e.failure.empty()) return &e;
  return nullptr;
}

/// Which states isolate terms, at one q; -1: none does.
struct Isolating {
  int still = kStill, pushed = kPushed, moving = kMoving, backward = kBackward, faster = kFaster;

  std::vector<int> found() const {
    std::vector<int> out;
    for (const int index : {still, pushed, moving, backward, faster})
      if (index >= 0) out.push_back(index);
    return out;
  }
};

/// Among states that somebody else has chosen: those of the q where most are.
Isolating isolatingAmong(const std::vector<scene::State<double>>& states) {
  using Rates = std::vector<double>;
  struct Here {
    int still = -1, pushed = -1;
    std::map<Rates, int> moving;  ///< by qd
  };
  std::map<std::vector<double>, Here> by_q;
  const auto isZero = [](const Rates& v) {
    return std::all_of(v.begin(), v.end(), [](double x) { return x == 0; });
  };
  for (std::size_t k = 0; k < states.size(); ++k) {
    std::vector<double> q;
    for (const auto& x : states[k].x) q.push_back(x.q);
    Here& here = by_q[q];
    const int index = static_cast<int>(k);
    if (!isZero(states[k].qd)) {
      if (isZero(states[k].qdd)) here.moving.emplace(states[k].qd, index);
    } else {
      (isZero(states[k].qdd) ? here.still : here.pushed) = index;
    }
  }
  Isolating best{-1, -1, -1, -1, -1};
  for (const auto& [q, here] : by_q) {
    Isolating one{here.still, here.pushed, -1, -1, -1};
    for (const auto& [qd, index] : here.moving) {
      const auto times = [&, &rates = qd](double k) {
        Rates other = rates;
        for (double& x : other) x *= k;
        const auto found = here.moving.find(other);
        return found == here.moving.end() ? -1 : found->second;
      };
      Isolating with = one;
      with.moving = index;
      with.backward = times(-1);
      with.faster = times(2);
      if (with.found().size() > one.found().size()) one = with;
    }
    if (one.found().size() > best.found().size()) best = one;
  }
  return best;
}

/// Of many, as many as diagnosis can take: those that isolate terms, and where it is worst.
std::vector<Exhibit> telling(const std::vector<Exhibit>& exhibits, const Isolating& isolating) {
  std::vector<std::pair<double, int>> worst;  // share of the limit, negative; state
  for (const Exhibit& e : exhibits)
    if (e.failure.empty() && e.is_wrong)
      worst.emplace_back(-(e.error.array() / e.bound.array().max(kTiniest)).maxCoeff(), e.index);
  std::sort(worst.begin(), worst.end());
  std::vector<int> kept = isolating.found();
  const auto isKept = [&](int index) { return std::count(kept.begin(), kept.end(), index) > 0; };
  for (const auto& [share, index] : worst)
    if (kept.size() < kChosenStates && !isKept(index)) kept.push_back(index);
  for (const Exhibit& e : exhibits)
    if (kept.size() < kChosenStates && !isKept(e.index)) kept.push_back(e.index);
  std::vector<Exhibit> out;
  for (const Exhibit& e : exhibits)
    if (isKept(e.index)) out.push_back(e);
  return out;
}

bool exceeds(const Eigen::MatrixXd& error, const Eigen::MatrixXd& bound) {
  return (error.cwiseAbs().array() > bound.array()).any();
}

/// A Jacobian, as an answer that is judged.
Exhibit exhibitOf(const OutsideClaims::SaidJacobian& said, const BoundedJacobian& J, double factor,
                  int index) {
  Exhibit out;
  out.index = index;
  out.failure = said.reason;
  if (!said.reason.empty()) return out;
  out.said = said.value;
  out.truth = J.value;
  out.bound = J.bound + factor * J.engine;
  out.error = (said.value - J.value).cwiseAbs();
  out.is_wrong = (out.error.array() > out.bound.array()).any();
  out.size = J.value.cwiseAbs().maxCoeff();
  const double off = out.error.maxCoeff();
  constexpr double kMostDigits = std::numeric_limits<double>::max_digits10;
  out.digits = off == 0       ? kMostDigits
               : out.size > 0 ? std::clamp(-std::log10(off / out.size), 0.0, kMostDigits)
                              : 0;
  return out;
}

/// What else than was asked is answered at all these states: the first reading that is, in words.
std::string readingOf(const std::vector<Exhibit>& exhibits,
                      const std::vector<BoundedJacobian>& ours) {
  std::vector<std::string> words;
  for (const JacobianReading& reading : otherReadings(ours.front())) words.push_back(reading.words);
  std::vector<bool> fits(words.size(), true);
  for (std::size_t k = 0; k < exhibits.size(); ++k) {
    if (!exhibits[k].failure.empty()) continue;
    const std::vector<JacobianReading> readings = otherReadings(ours[k]);
    const double limit = exhibits[k].bound.maxCoeff(), size = exhibits[k].size;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      // about another point its numbers are larger, and so is what is lost of them
      const double here = readings[i].value.cwiseAbs().maxCoeff();
      const double growth = size > 0 ? std::max(1.0, here / size) : 1.0;
      const double off = (exhibits[k].said - readings[i].value).cwiseAbs().maxCoeff();
      fits[i] = fits[i] && off <= 2 * growth * limit + kEps * std::max(here, size);
    }
  }
  const auto first = std::find(fits.begin(), fits.end(), true);
  return first == fits.end() ? "" : words[static_cast<std::size_t>(first - fits.begin())];
}

/// What it says besides quantities.
void examineClaims(OutsideClaims& claims, const scene::Scene& scene,
                   const std::vector<scene::State<double>>& chosen, double factor,
                   Examination& out) {
  if (const auto links = claims.believedLinks()) {
    const ModelFound model = compareModel(scene.mechanism, *links, factor);
    out.model.is_told = true;
    out.model.differences = model.differences;
    for (const std::string& sentence : model.merged) out.remarks.push_back("its model " + sentence);
  }
  QuantityFound jacobian;
  jacobian.name = kJacobian;
  jacobian.reason = "the engine does not know it";
  if (claims.knowsJacobian()) {
    const FramePoint point = farthestPoint(scene.mechanism);
    out.frame = wordsOf(point, scene.mechanism);
    std::vector<scene::State<double>> states;
    std::vector<int> indices;
    for (std::size_t k = 0; k < chosen.size(); ++k)
      if (isAskedAt(Quantity::kM, static_cast<int>(k))) {
        states.push_back(chosen[k]);
        indices.push_back(static_cast<int>(k));
      }
    const std::vector<OutsideClaims::SaidJacobian> said = claims.jacobians(point, states);
    FrameJacobian frame(scene);
    std::vector<BoundedJacobian> ours;
    std::vector<Exhibit> exhibits;
    for (std::size_t k = 0; k < states.size(); ++k) {
      ours.push_back(frame(point, states[k]));
      exhibits.push_back(exhibitOf(said[k], ours.back(), factor, indices[k]));
    }
    jacobian = found(jacobian.name, Quantity::kM, false, exhibits);
    if (jacobian.verdict == Judged::kWrong) out.jacobian_reading = readingOf(exhibits, ours);
  }
  jacobian.is_jacobian = true;
  out.quantities.push_back(jacobian);
}

/// How errors grow: from the states that isolate terms.
void tellGrowth(const std::vector<Exhibit>& exhibits, const Isolating& at, Where& where) {
  const auto direct = [&](Quantity quantity) -> std::optional<bool> {
    std::optional<bool> out;
    for (const Exhibit& e : exhibits)
      if (e.asked == quantity && e.failure.empty()) out = out.value_or(false) || e.is_wrong;
    return out;
  };
  const Quantity kTau = Quantity::kTau;
  const Exhibit *still = exhibitAt(exhibits, kTau, at.still),
                *pushed = exhibitAt(exhibits, kTau, at.pushed),
                *moving = exhibitAt(exhibits, kTau, at.moving),
                *backward = exhibitAt(exhibits, kTau, at.backward),
                *faster = exhibitAt(exhibits, kTau, at.faster);
  const auto off = [](const Exhibit* e) { return Eigen::MatrixXd(e->said - e->truth); };
  std::optional<bool> tau_M, tau_g, tau_even, tau_odd;  // nothing: the states do not isolate it
  if (still) tau_g = exceeds(off(still), still->bound);
  if (still && pushed) tau_M = exceeds(off(pushed) - off(still), pushed->bound + still->bound);
  if (moving && backward) {
    const Eigen::MatrixXd two = moving->bound + backward->bound;
    tau_odd = exceeds(off(moving) - off(backward), two);
    if (still)
      tau_even = exceeds(off(moving) + off(backward) - 2 * off(still), two + 2 * still->bound);
  }
  if (tau_g == true) where.growth.emplace_back("tau is off at rest: in gravity, springs or loads");
  if (tau_M == true) where.growth.emplace_back("the error of tau grows with qdd: in M");
  if (tau_even == true)
    where.growth.emplace_back("the error of tau has a part that is even in qd: in c");
  if (tau_odd == true)
    where.growth.emplace_back("the error of tau has a part that is odd in qd: in friction");
  if (tau_even == true && faster) {
    const Eigen::MatrixXd two = moving->bound + backward->bound;
    const Eigen::MatrixXd once = (off(moving) + off(backward)) / 2 - off(still);
    const Eigen::MatrixXd odd = (off(moving) - off(backward)) / 2;
    const Eigen::MatrixXd twice = off(faster) - off(still) - 2 * odd;
    if (!exceeds(twice - 4 * once, faster->bound + 4 * two + 8 * still->bound))
      where.growth.emplace_back("it grows with qd^2");
  }
  const auto term = [&](const char* name, const std::optional<bool>& own,
                        const std::optional<bool>& in_tau, const char* needed) {
    const std::optional<bool> is_wrong = own ? own : in_tau;
    where.terms.push_back(fmt::format("{}: {}{}", name,
                                      !is_wrong   ? "not told"
                                      : *is_wrong ? "wrong"
                                                  : "right",
                                      is_wrong && !own ? " in tau" : ""));
    if (own && in_tau && *own != *in_tau)
      where.growth.push_back(fmt::format("{} is {} by itself and {} in tau", name,
                                         *own ? "wrong" : "right", *in_tau ? "wrong" : "right"));
    if (!is_wrong && direct(kTau))
      where.growth.push_back(
          fmt::format("the states do not isolate {} in tau: that takes {}", name, needed));
  };
  term("M", direct(Quantity::kM), tau_M,
       "one at rest and one accelerated from rest, at the same q");
  term("c", direct(Quantity::kc), tau_even,
       "one at rest and two with opposite qd, at the same q, "
       "qdd = 0");
  term("g", direct(Quantity::kg), tau_g, "one at rest, qd = qdd = 0");
  if (direct(kTau)) term("friction", {}, tau_odd, "two with opposite qd, at the same q, qdd = 0");
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
  return !failure.empty() || !model.differences.empty() ||
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
  out.single = options.single;
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
  const bool is_given = !options.states.empty();
  const std::vector<scene::State<double>> chosen =
      is_given ? options.states
               : chosenStates(scene.mechanism, scene.name, options.seed, options.single);
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
    if (!witness->answers(quantity)) {
      QuantityFound missing;
      missing.name = name(quantity);
      missing.reason = "the engine does not know it";
      out.quantities.push_back(missing);
      continue;
    }
    for (int k = 0; k < out.states; ++k)
      if (is_given || isAskedAt(quantity, k))
        exhibits.push_back(bench.ask(quantity, chosen[static_cast<std::size_t>(k)], k));
    std::vector<std::string> entries;
    if (quantity == Quantity::kReactions) entries = columnNames(quantity, scene.mechanism);
    out.quantities.push_back(
        found(name(quantity), quantity, isByRates(quantity), exhibits, entries));
  }
  if (auto* claims = dynamic_cast<OutsideClaims*>(witness.get())) try {
      examineClaims(*claims, scene, chosen, factor, out);
    } catch (const std::runtime_error& failure) {  // it has failed at the last question
      out.failure = failure.what();
      return out;
    }
  work.done();
  for (const QuantityFound& q : out.quantities)
    for (const int rate : q.rates)
      if (std::count(out.where.rates.begin(), out.where.rates.end(), rate) == 0)
        out.where.rates.push_back(rate);
  std::sort(out.where.rates.begin(), out.where.rates.end());
  if (!out.isWrong()) {
    const bool judged =
        std::any_of(out.quantities.begin(), out.quantities.end(),
                    [](const QuantityFound& q) { return q.verdict == Judged::kRight; });
    if (!judged && !out.model.is_told) out.failure = nothingJudged(out);
    return out;
  }

  const Isolating isolating = is_given ? isolatingAmong(chosen) : Isolating();
  tellGrowth(exhibits, isolating, out.where);
  if (chosen.size() < kStill)
    out.where.growth.push_back(
        fmt::format("what follows goes by {} state{}: other mistakes may answer the same there",
                    chosen.size(), chosen.size() == 1 ? "" : "s"));
  if (chosen.size() > kChosenStates) {
    exhibits = telling(exhibits, isolating);
    out.where.growth.push_back(
        fmt::format("what follows goes by {} of the {} states", kChosenStates, chosen.size()));
  }
  const bool has_wrong_answers =
      std::any_of(exhibits.begin(), exhibits.end(), [](const Exhibit& e) { return e.is_wrong; });
  if (options.explain && has_wrong_answers) {
    const Explained explained_by = explained(textbookModel(scene), exhibits, chosen);
    out.findings = explained_by.findings;
    out.tried = explained_by.tried;
    out.pairs = explained_by.pairs;
    out.pairs_tried = explained_by.pairs_tried;
  }
  if (options.smallest && options.explain && !is_given && !out.isExplained()) {
    const auto worst =
        std::find_if(exhibits.begin(), exhibits.end(), [](const Exhibit& e) { return e.is_wrong; });
    if (worst != exhibits.end())
      out.smallest = smallestFailure(scene, kind, worst->asked,
                                     chosen[static_cast<std::size_t>(worst->index)], factor);
  }
  return out;
}

}  // namespace dynwitness::crosscheck
