// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/explain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <Eigen/QR>

#include "crosscheck/diagnosis/hypotheses.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double kEps = std::numeric_limits<double>::epsilon();
/// Pairs that are looked at, at most: those of the hypotheses that come nearest alone.
constexpr long kMostPairs = 100'000;
constexpr long kMostPairsWithEstimates = 40'000;
constexpr std::size_t kNearest = 5;  ///< that are told where none explains

bool isForce(Quantity quantity) {
  return quantity == Quantity::kM || quantity == Quantity::kc || quantity == Quantity::kg ||
         quantity == Quantity::kTau || quantity == Quantity::kQdd;
}
bool isPredicted(Quantity quantity) {
  return isForce(quantity) || quantity == Quantity::kKinetic || quantity == Quantity::kPotential;
}
double largest(const MatrixXd& m) {
  return m.size() == 0 ? 0 : m.cwiseAbs().maxCoeff();
}

/// How far a prediction is from what was said.
struct Misfit {
  double share = 0;     ///< of the limit
  double ulp = 0;       ///< of the largest entry
  double relative = 0;  ///< to the largest entry
};

/// The limits of a prediction, entry by entry.
MatrixXd limitOf(const Exhibit& exhibit, const MatrixXd& predicted, bool permuted) {
  const double truth = largest(exhibit.truth), here = largest(predicted);
  const double growth = truth > 0 ? std::max(1.0, here / truth) : 1.0;
  MatrixXd bound = exhibit.bound;
  if (permuted) bound.setConstant(largest(bound));
  return (2 * growth * bound).array() + kEps * std::max(here, truth);
}

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

/// All that is compared with predictions.
class Case {
 public:
  Case(const TextbookModel& model, const std::vector<Exhibit>& exhibits,
       const std::vector<scene::State<double>>& chosen)
      : chosen_(chosen) {
    right_.model = model;
    std::vector<Quantity> wrong;
    for (const Exhibit& e : exhibits)
      if (e.is_wrong && std::count(wrong.begin(), wrong.end(), e.asked) == 0)
        wrong.push_back(e.asked);
    const auto isWrong = [&](Quantity q) { return std::count(wrong.begin(), wrong.end(), q) > 0; };
    const bool forces = std::any_of(wrong.begin(), wrong.end(), isForce);
    for (const Exhibit& e : exhibits) {
      if (!e.failure.empty()) continue;
      if (!isPredicted(e.asked)) continue;
      const bool counts = isWrong(e.asked) && (!forces || isForce(e.asked));
      (counts ? primary_ : others_).push_back(&e);
    }
    for (const Quantity q : wrong)
      if (!isPredicted(q)) unpredicted_.emplace_back(crosscheck::name(q));
    // cheap and telling first: what needs one sweep, at a generic state
    const auto cost = [](const Exhibit* e) {
      return std::make_tuple(!e->is_wrong, e->compared == Quantity::kM, e->index);
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
        throw std::logic_error(
            fmt::format("diagnosis: the textbook's {} is {} limits from the certified truth",
                        crosscheck::name(e->compared), own.share));
    }
  }

  const Belief& right() const { return right_; }
  const std::vector<const Exhibit*>& heads() const { return heads_; }
  const std::vector<const Exhibit*>& primary() const { return primary_; }
  const std::vector<const Exhibit*>& others() const { return others_; }
  const std::vector<std::string>& unpredicted() const { return unpredicted_; }
  const std::vector<scene::State<double>>& chosen() const { return chosen_; }

  /// Nothing: it is beyond its limit somewhere.
  std::optional<Misfit> whole(const Belief& belief) const {
    const Textbook textbook(belief);
    const bool permuted = !belief.passing.order.empty();
    Misfit all;
    bool looked = false;
    for (const Exhibit* e : primary_) {
      if (e->compared == Quantity::kM && !looked) {
        looked = true;  // M qdd takes one sweep, M one a column
        if (!(misfitOf(productOf(*e), textbook.inertial(e->state), permuted).share <= 1)) return {};
      }
      const Misfit one = misfitOf(*e, textbook(e->compared, e->state), permuted);
      if (!(one.share <= 1)) return {};
      keepWorse(all, one);
    }
    return all;
  }
  /// The share of the misfit that is left, of the quantity of which most is.
  double left(const Textbook& textbook) const {
    double out = 0;
    for (const Exhibit* e : heads_) {
      const MatrixXd predicted = textbook(e->compared, e->state);
      const double before = (e->said - e->truth).norm();
      out = std::max(out, before > 0 ? (e->said - predicted).norm() / before : 0);
    }
    return out;
  }
  /// Quantities that are right, which the belief would have made wrong; and wrong ones that it does
  /// not account for.
  void compareOthers(const Belief& belief, CheckFinding& finding) const {
    const Textbook textbook(belief);
    finding.unasked = unpredicted_;
    for (const Exhibit* e : others_) {
      const Misfit one =
          misfitOf(*e, textbook(e->compared, e->state), !belief.passing.order.empty());
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

 private:
  /// M qdd in place of M, with what the errors of M may make of it.
  static Exhibit productOf(const Exhibit& e) {
    const VectorXd qdd = Eigen::Map<const VectorXd>(e.state.qdd.data(), e.said.cols());
    const double n = static_cast<double>(qdd.size());
    Exhibit out = e;
    out.compared = Quantity::kTau;
    out.said = e.said * qdd;
    out.truth = e.truth * qdd;
    out.bound = (e.bound + n * kEps * e.truth.cwiseAbs()) * qdd.cwiseAbs();
    return out;
  }
  static Misfit fromTruth(const Exhibit& e, const MatrixXd& predicted) {
    Exhibit own = e;
    own.said = e.truth;
    return misfitOf(own, predicted, false);
  }

  Belief right_;
  const std::vector<scene::State<double>>& chosen_;
  std::vector<const Exhibit*> primary_, others_, heads_;
  std::vector<std::string> unpredicted_;
};

Explanation wordsOf(const Hypothesis& h) {
  return {h.rule, h.link, h.at_joint, h.sentence, {}};
}

CheckFinding findingOf(const Case& all, const Belief& belief, std::vector<Explanation> parts,
                       const Misfit& misfit) {
  CheckFinding out;
  out.parts = std::move(parts);
  out.explains = true;
  out.residual = misfit.share;
  out.residual_ulp = misfit.ulp;
  out.residual_relative = misfit.relative;
  all.compareOthers(belief, out);
  return out;
}

/// What an estimate is made of: said - predicted in units of the limits, over the primary exhibits
/// at these states.
VectorXd stacked(const std::vector<const Exhibit*>& exhibits, const Belief& belief,
                 bool predicted_alone) {
  const Textbook textbook(belief);
  std::vector<double> out;
  for (const Exhibit* e : exhibits) {
    const MatrixXd predicted = textbook(e->compared, e->state);
    const MatrixXd limit = limitOf(*e, e->truth, false);
    for (Eigen::Index k = 0; k < predicted.size(); ++k) {
      const double l = limit.data()[k];
      const double value =
          predicted_alone ? predicted.data()[k] : e->said.data()[k] - predicted.data()[k];
      out.push_back(l > 0 ? value / l : 0);
    }
  }
  return Eigen::Map<const VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

/** The value of a suspect number that comes nearest, on top of a belief. Forces are polynomials of
    second degree at most in each of them, so that three predictions give the whole function of one;
    several (an inertia's six) enter linearly.
    @param quick  only whether there is such a value of one number
    @return       nothing: no value brings the predictions within the limits */
std::optional<VectorXd> estimated(const std::vector<const Exhibit*>& exhibits, const Belief& base,
                                  const Suspect& suspect, VectorXd* uncertainty,
                                  bool quick = false) {
  const auto d = static_cast<Eigen::Index>(suspect.names.size());
  const auto with = [&](const VectorXd& added) {
    Belief belief = base;
    suspect.apply(belief, added);
    return belief;
  };
  const VectorXd zero = VectorXd::Zero(d);
  const VectorXd D = stacked(exhibits, base, false), f0 = stacked(exhibits, base, true);
  MatrixXd b(D.size(), d);
  VectorXd a = VectorXd::Zero(D.size());
  for (Eigen::Index k = 0; k < d; ++k) {
    const double h = suspect.scale[static_cast<std::size_t>(k)];
    VectorXd step = zero;
    step(k) = h;
    const VectorXd forward = stacked(exhibits, with(step), true),
                   backward = stacked(exhibits, with(-step), true);
    if (!forward.allFinite() || !backward.allFinite()) return {};
    b.col(k) = (forward - backward) / (2 * h);
    if (d == 1) a = (forward + backward - 2 * f0) / (2 * h * h);
  }
  if (!(b.cwiseAbs().maxCoeff() > 0) && !(a.cwiseAbs().maxCoeff() > 0)) return {};
  VectorXd s = zero;
  MatrixXd slope = b;
  if (d > 1) {
    s = b.completeOrthogonalDecomposition().solve(D);
  } else {
    const VectorXd b1 = b.col(0);
    std::vector<double> starts = {b1.squaredNorm() > 0 ? b1.dot(D) / b1.squaredNorm() : 0.0};
    Eigen::Index at = 0;
    D.cwiseAbs().maxCoeff(&at);
    const double square = b1(at) * b1(at) + 4 * a(at) * D(at);
    if (a(at) != 0 && square >= 0)
      for (const int sign : {-1, 1})
        starts.push_back((-b1(at) + sign * std::sqrt(square)) / (2 * a(at)));
    double best = std::numeric_limits<double>::infinity();
    constexpr int kPolish = 6;
    for (double x : starts) {
      for (int k = 0; k < kPolish; ++k) {
        const VectorXd slope_here = b1 + 2 * x * a;
        const double norm = slope_here.squaredNorm();
        if (norm > 0) x += slope_here.dot(D - x * b1 - x * x * a) / norm;
      }
      const double miss = (D - x * b1 - x * x * a).norm();
      if (miss < best) best = miss, s(0) = x;
    }
    slope = b1 + 2 * s(0) * a;
    // what is left has to be within the limits, and within what the differences lose of them
    const double steps = std::abs(s(0)) / suspect.scale[0];
    double growth = 1;
    for (const Exhibit* e : exhibits)
      if (largest(e->truth) > 0) growth = std::max(growth, largest(e->said) / largest(e->truth));
    const double left = (D - s(0) * b1 - s(0) * s(0) * a).cwiseAbs().maxCoeff();
    if (!(left <= 2 * growth * (1 + steps + 2 * steps * steps))) return {};
    if (quick) return s;
  }
  constexpr int kRefine = 2;  // from what the differences lost
  for (int k = 0; k < kRefine; ++k) {
    const VectorXd off = stacked(exhibits, with(s), false);
    if (!off.allFinite()) return {};
    s += slope.completeOrthogonalDecomposition().solve(off);
  }
  // so far each may go alone before an entry leaves its limit
  *uncertainty = zero;
  for (Eigen::Index k = 0; k < d; ++k) {
    const double steepest = slope.col(k).cwiseAbs().maxCoeff();
    (*uncertainty)(k) = steepest > 0 ? 1 / steepest : std::numeric_limits<double>::infinity();
  }
  return s;
}

Explanation wordsOf(const Suspect& suspect, const VectorXd& added, const VectorXd& uncertainty) {
  Explanation out{suspect.rule, suspect.link, suspect.at_joint, "", {}};
  std::string values;
  for (std::size_t k = 0; k < suspect.names.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    Estimate e{suspect.names[k], suspect.unit, suspect.scene[k], suspect.scene[k] + added(i),
               uncertainty(i)};
    if (suspect.names.size() > 1 && std::abs(added(i)) <= uncertainty(i))
      continue;  // as it should be
    values +=
        fmt::format("{}{} = {:.10g} +- {:.1g} {}{}for {:.10g}", values.empty() ? "" : ", ", e.name,
                    e.value, e.uncertainty, e.unit, e.unit.empty() ? "" : " ", e.scene);
    out.estimates.push_back(e);
  }
  out.sentence = fmt::format("{}: {}", suspect.what, values);
  return out;
}

void addSingles(const Case& all, const std::vector<Hypothesis>& list, Explained& out) {
  for (const Hypothesis& h : list) {
    Belief belief = all.right();
    h.apply(belief);
    ++out.tried;
    if (const auto misfit = all.whole(belief))
      out.findings.push_back(findingOf(all, belief, {wordsOf(h)}, *misfit));
  }
}

/// The state that was asked before, in part.
void addStale(const Case& all, Explained& out) {
  const Textbook textbook(all.right());
  for (const Stale& stale : staleStates()) {
    ++out.tried;
    Misfit worst;
    bool holds = true, differs = false;
    for (const Exhibit* e : all.primary()) {
      if (e->index == 0) continue;  // nobody knows what it began with
      const scene::State<double>& before = all.chosen()[static_cast<std::size_t>(e->index) - 1];
      scene::State<double> mixed = e->state;
      if (stale.q) mixed.x = before.x;
      if (stale.qd) mixed.qd = before.qd;
      if (stale.qdd) mixed.qdd = before.qdd;
      const Misfit one = misfitOf(*e, textbook(e->compared, mixed), false);
      differs = differs || e->is_wrong;
      holds = holds && one.share <= 1;
      keepWorse(worst, one);
      if (!holds) break;
    }
    if (!holds || !differs) continue;
    CheckFinding finding =
        findingOf(all, all.right(), {{"stale_state", -1, false, stale.sentence, {}}}, worst);
    finding.spared.clear();
    out.findings.push_back(finding);
  }
}

void addEstimates(const Case& all, const std::vector<Suspect>& list, Explained& out) {
  std::vector<const Exhibit*> some;  // generic states are enough to estimate from
  for (const Exhibit* e : all.primary())
    if (e->index < kStill || e->index == kFaster) some.push_back(e);
  if (some.empty()) some = all.primary();
  for (const Suspect& suspect : list) {
    ++out.tried;
    VectorXd uncertainty;
    if (suspect.names.size() == 1 &&
        !estimated({all.heads().front()}, all.right(), suspect, &uncertainty, true))
      continue;
    const auto added = estimated(some, all.right(), suspect, &uncertainty);
    if (!added) continue;
    Belief belief = all.right();
    suspect.apply(belief, *added);
    if (const auto misfit = all.whole(belief))
      out.findings.push_back(
          findingOf(all, belief, {wordsOf(suspect, *added, uncertainty)}, *misfit));
  }
}

/// All that is wrong is so by no more than single precision loses.
void addSingle(const Case& all, Explained& out) {
  constexpr double kSingle = 0x1p29;  // roundings of float in those of double
  Misfit worst;
  bool rounded = true;  // every number is one of single precision
  for (const Exhibit* e : all.primary()) {
    Misfit one = misfitOf(*e, e->truth, false);
    one.share /= kSingle;
    keepWorse(worst, one);
    for (Eigen::Index k = 0; k < e->said.size(); ++k) {
      const double x = e->said.data()[k];
      rounded = rounded &&
                (e->asked == Quantity::kQdd || static_cast<double>(static_cast<float>(x)) == x);
    }
  }
  ++out.tried;
  // smaller errors than those of a float are no float's
  if (worst.share > 1 || (!rounded && worst.relative < std::numeric_limits<float>::epsilon() / 4))
    return;
  out.findings.push_back(
      findingOf(all, all.right(),
                {{"float_precision",
                  -1,
                  false,
                  rounded ? "single precision (float): all numbers have 24 bits"
                          : "single precision (float) somewhere: errors of its size",
                  {}}},
                worst));
}

struct Candidate {
  const Hypothesis* hypothesis;
  double left;
  VectorXd head;  ///< what it predicts first
};

/// Those that change anything, each prediction once, the nearest first.
std::vector<Candidate> candidates(const Case& all, const std::vector<Hypothesis>& list) {
  std::vector<Candidate> out;
  if (all.heads().empty()) return out;
  const VectorXd truth = stacked(all.heads(), all.right(), true);
  for (const Hypothesis& h : list) {
    if (h.rule == "sine_series") continue;
    Belief belief = all.right();
    h.apply(belief);
    const VectorXd head = stacked(all.heads(), belief, true);
    const auto same = [&](const VectorXd& other) {
      return head.size() == other.size() && (head - other).cwiseAbs().maxCoeff() <= 1;
    };
    if (!head.allFinite() || same(truth)) continue;
    if (std::any_of(out.begin(), out.end(), [&](const Candidate& c) { return same(c.head); }))
      continue;
    out.push_back({&h, all.left(Textbook(belief)), head});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Candidate& a, const Candidate& b) { return a.left < b.left; });
  return out;
}

void addPairs(const Case& all, const std::vector<Candidate>& list, Explained& out) {
  const auto n = static_cast<long>(list.size());
  out.pairs = n * (n - 1) / 2;
  long count = n;
  while (count * (count - 1) / 2 > kMostPairs) --count;
  for (long i = 0; i < count; ++i) {
    Belief first = all.right();
    list[static_cast<std::size_t>(i)].hypothesis->apply(first);
    for (long j = i + 1; j < count; ++j) {
      const Hypothesis &a = *list[static_cast<std::size_t>(i)].hypothesis,
                       &b = *list[static_cast<std::size_t>(j)].hypothesis;
      Belief belief = first;
      b.apply(belief);
      ++out.pairs_tried;
      if (const auto misfit = all.whole(belief))
        out.findings.push_back(findingOf(all, belief, {wordsOf(a), wordsOf(b)}, *misfit));
    }
  }
}

/// A mistake, and a number that is another one.
void addPairsWithEstimates(const Case& all, const std::vector<Candidate>& list,
                           const std::vector<Suspect>& numbers, Explained& out) {
  const std::vector<const Exhibit*> head = {all.heads().front()};
  out.pairs += static_cast<long>(list.size() * numbers.size());
  long left = kMostPairsWithEstimates;
  for (const Candidate& c : list) {
    Belief base = all.right();
    c.hypothesis->apply(base);
    for (const Suspect& suspect : numbers) {
      if (suspect.names.size() != 1) continue;
      if (left-- == 0) return;
      ++out.pairs_tried;
      VectorXd uncertainty;
      if (!estimated(head, base, suspect, &uncertainty, true)) continue;
      const auto added = estimated(all.primary(), base, suspect, &uncertainty);
      if (!added) continue;
      Belief belief = base;
      suspect.apply(belief, *added);
      if (const auto misfit = all.whole(belief))
        out.findings.push_back(findingOf(
            all, belief, {wordsOf(*c.hypothesis), wordsOf(suspect, *added, uncertainty)}, *misfit));
    }
  }
}

void addNearest(const std::vector<Candidate>& list, Explained& out) {
  for (const Candidate& c : list) {
    if (out.findings.size() == kNearest || !(c.left < 1)) break;
    CheckFinding finding;
    finding.parts = {wordsOf(*c.hypothesis)};
    finding.left = c.left;
    out.findings.push_back(finding);
  }
}

/// Of findings of the same rule at the same place the first.
void withoutRepetitions(std::vector<CheckFinding>& findings) {
  const auto key = [](const CheckFinding& f) {
    std::string out;
    for (const Explanation& part : f.parts)
      out += fmt::format("{} {} {};", part.rule, part.link, part.at_joint);
    return out;
  };
  std::vector<CheckFinding> kept;
  for (const CheckFinding& f : findings)
    if (std::none_of(kept.begin(), kept.end(),
                     [&](const CheckFinding& k) { return key(k) == key(f); }))
      kept.push_back(f);
  findings = std::move(kept);
}

}  // namespace

Explained explained(const TextbookModel& model, const std::vector<Exhibit>& exhibits,
                    const std::vector<scene::State<double>>& chosen) {
  Explained out;
  const Case all(model, exhibits, chosen);
  if (all.primary().empty()) return out;
  const std::vector<Hypothesis> list = hypotheses(model);
  const auto rank = [&](const CheckFinding& f) {
    return std::make_pair(f.unasked.size(), f.spared.size());
  };
  const auto sort = [&] {
    std::stable_sort(
        out.findings.begin(), out.findings.end(),
        [&](const CheckFinding& a, const CheckFinding& b) { return rank(a) < rank(b); });
    withoutRepetitions(out.findings);
  };
  const scene::Work work("hypotheses", 4);
  addSingles(all, list, out);
  addStale(all, out);
  if (out.findings.empty()) addEstimates(all, suspects(model), out);
  if (out.findings.empty()) addSingle(all, out);
  if (out.findings.empty()) {
    const std::vector<Candidate> near = candidates(all, list);
    addPairs(all, near, out);
    if (out.findings.empty()) addPairsWithEstimates(all, near, suspects(model), out);
    if (out.findings.empty()) addNearest(near, out);
  }
  sort();
  return out;
}

}  // namespace dynwitness::crosscheck
