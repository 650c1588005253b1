// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/explain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <Eigen/QR>

#include "crosscheck/diagnosis/hypotheses.hpp"
#include "crosscheck/diagnosis/suspects.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double kEps = std::numeric_limits<double>::epsilon();
/// Pairs that are looked at, at most: the nearest, when the effects of the two are added up.
constexpr long kMostPairs = 100'000;
constexpr long kMostPairsWithEstimates = 40'000;
constexpr long kMostPairsOfEstimates = 500;
constexpr std::size_t kNearest = 5;  ///< that are told where none explains

/// The shortest s of all with the least |A s - b|.
Eigen::VectorXd leastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

bool isForce(Quantity quantity) {
  return quantity == Quantity::kM || quantity == Quantity::kc || quantity == Quantity::kg ||
         quantity == Quantity::kTau || quantity == Quantity::kQdd;
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

/// Which of the wrong quantities an explanation has to account for.
enum class Scope { kAll, kForces };

using State = scene::State<double>;

/// All that is compared with predictions.
class Case {
 public:
  Case(const TextbookModel& model, const std::vector<Exhibit>& exhibits,
       const std::vector<State>& chosen, Scope scope)
      : chosen_(chosen) {
    right_.model = model;
    std::vector<Quantity> wrong;
    for (const Exhibit& e : exhibits) {
      if (e.is_wrong && std::count(wrong.begin(), wrong.end(), e.asked) == 0)
        wrong.push_back(e.asked);
      if (e.failure.empty() && e.asked != Quantity::kQdd)
        loose_[e.asked] = std::max(loose_[e.asked], largest(limitOf(e, e.truth, false)) /
                                                        sizeOf(e.asked, e.truth, e.state));
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

  const Belief& right() const { return right_; }
  const std::vector<const Exhibit*>& heads() const { return heads_; }
  const std::vector<const Exhibit*>& primary() const { return primary_; }
  /// Of these, what a belief can be asked about: nobody knows the question before the first.
  static bool isAnswerable(const Belief& belief, const Exhibit& e) {
    return !isStale(belief) || e.index > 0;
  }
  /// What is compared.
  MatrixXd predicted(const Textbook& textbook, const Belief& belief, const Exhibit& e) const {
    const bool solved = e.asked == Quantity::kQdd;
    if (!isStale(belief)) return textbook(e.compared, e.state, solved);
    return textbook(e.compared, mixed(belief, e), solved);
  }
  /// The same, of M only what it makes of qdd: one sweep for one a column.
  MatrixXd glanced(const Textbook& textbook, const Belief& belief, const Exhibit& e) const {
    if (e.compared != Quantity::kM) return predicted(textbook, belief, e);
    State state = isStale(belief) ? mixed(belief, e) : e.state;
    state.qdd = e.state.qdd;
    return textbook.inertial(state);
  }

  /// Nothing: it is beyond its limit somewhere.
  std::optional<Misfit> whole(const Belief& belief) const {
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
  /// Quantities that are right, which the belief would have made wrong; and wrong ones that it does
  /// not account for.
  void compareOthers(const Belief& belief, CheckFinding& finding) const {
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
  /** Whether two beliefs give the same answers to all that the engine knows, at states that nobody
      has asked: to as many roundings as are allowed at those that were. */
  bool areOne(const Belief& one, const Belief& other) const {
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

  /// What is left of the misfits, head by head, in units of their limits; or predictions alone.
  /// @param glance  of M what it makes of qdd
  VectorXd stacked(const std::vector<const Exhibit*>& exhibits, const Belief& belief,
                   bool predicted_alone, bool glance = false) const {
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
        const double value =
            predicted_alone ? told.data()[k] : here.said.data()[k] - told.data()[k];
        out.push_back(l > 0 ? value / l : 0);
      }
    }
    return Eigen::Map<const VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
  }

 private:
  static bool isStale(const Belief& belief) {
    return belief.stale.q || belief.stale.qd || belief.stale.qdd;
  }
  State mixed(const Belief& belief, const Exhibit& e) const {
    const State& before = chosen_[static_cast<std::size_t>(e.index) - 1];
    State out = e.state;
    if (belief.stale.q) out.x = before.x;
    if (belief.stale.qd) out.qd = before.qd;
    if (belief.stale.qdd && e.asked != Quantity::kQdd) out.qdd = before.qdd;
    return out;
  }
  /// The largest of the terms that tau is the sum of.
  static double termsOf(const Textbook& textbook, const State& state) {
    return std::max({largest(textbook.inertial(state)), largest(textbook(Quantity::kc, state)),
                     largest(textbook(Quantity::kg, state))});
  }
  /// What roundings are measured in. Forces are sums of terms that may cancel.
  double sizeOf(Quantity quantity, const MatrixXd& value, const State& state) const {
    double size = largest(value);
    if (isForce(quantity) && quantity != Quantity::kM && state.qdd.size() == state.qd.size())
      size = std::max(size, termsOf(Textbook(right_), state));
    return size > 0 ? size : 1;
  }
  /// A mistake may make the terms of a sum larger that cancel in it.
  Misfit misfitHere(const Textbook& textbook, const Belief& belief, const Exhibit& e,
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
  const std::vector<State>& chosen_;
  std::vector<const Exhibit*> primary_, others_, heads_;
  std::map<Quantity, double> loose_;  ///< limit of a quantity that is known, of its size
};

/// A finding, and what it believes.
struct Found {
  CheckFinding finding;
  Belief belief;
};
struct Search {
  std::vector<Found> found;
  long tried = 0, pairs_tried = 0, pairs = 0;
};

Explanation wordsOf(const Hypothesis& h) {
  return {h.rule, h.link, h.at_joint, h.sentence, {}};
}

Found findingOf(const Case& all, const Belief& belief, std::vector<Explanation> parts,
                const Misfit& misfit) {
  CheckFinding out;
  out.parts = std::move(parts);
  out.explains = true;
  out.residual = misfit.share;
  out.residual_ulp = misfit.ulp;
  out.residual_relative = misfit.relative;
  all.compareOthers(belief, out);
  return {out, belief};
}

/** The value of a suspect number that comes nearest, on top of a belief. Forces are polynomials of
    second degree at most in each of them, so that three predictions give the whole function of one;
    several are sought by Gauss and Newton (an inertia's six enter linearly).
    @param quick  only whether there is such a value of one number
    @return       nothing: no value brings the predictions within the limits */
std::optional<VectorXd> estimated(const Case& all, const std::vector<const Exhibit*>& exhibits,
                                  const Belief& base, const Suspect& suspect, VectorXd* uncertainty,
                                  bool quick = false) {
  const auto d = static_cast<Eigen::Index>(suspect.names.size());
  const auto with = [&](const VectorXd& added) {
    Belief belief = base;
    suspect.apply(belief, added);
    return belief;
  };
  const auto predicted = [&](const VectorXd& added) {
    return all.stacked(exhibits, with(added), true);
  };
  const VectorXd zero = VectorXd::Zero(d);
  const VectorXd D = all.stacked(exhibits, base, false);
  if (!D.allFinite()) return {};
  /// First and second derivative at a value, by differences.
  struct Slopes {
    MatrixXd b;
    VectorXd a;
  };
  const auto slopesAt = [&](const VectorXd& s, const VectorXd& f0) -> std::optional<Slopes> {
    Slopes out{MatrixXd(D.size(), d), VectorXd::Zero(D.size())};
    for (Eigen::Index k = 0; k < d; ++k) {
      const double h = suspect.scale[static_cast<std::size_t>(k)];
      VectorXd step = zero;
      step(k) = h;
      const VectorXd forward = predicted(s + step), backward = predicted(s - step);
      if (!forward.allFinite() || !backward.allFinite()) return {};
      out.b.col(k) = (forward - backward) / (2 * h);
      if (d == 1) out.a = (forward + backward - 2 * f0) / (2 * h * h);
    }
    return out;
  };
  const auto slopes = slopesAt(zero, all.stacked(exhibits, base, true));
  if (!slopes) return {};
  const VectorXd& a = slopes->a;
  MatrixXd slope = slopes->b;
  if (!(slope.cwiseAbs().maxCoeff() > 0) && !(a.cwiseAbs().maxCoeff() > 0)) return {};
  VectorXd s = zero;
  if (d > 1) {
    s = leastSquares(slope, D);
  } else {
    const VectorXd b1 = slope.col(0);
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
  constexpr int kRefine = 2, kNewton = 8;  // one: from what the differences lost
  for (int k = 0; k < (suspect.is_linear || d == 1 ? kRefine : kNewton); ++k) {
    if (d > 1 && !suspect.is_linear) {
      const auto here = slopesAt(s, D);
      if (!here) return {};
      slope = here->b;
    }
    const VectorXd off = all.stacked(exhibits, with(s), false);
    if (!off.allFinite()) return {};
    s += leastSquares(slope, off);
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

constexpr double kSingle = 0x1p29;  ///< roundings of float in those of double

/// Whether every number is one of single precision, those aside that are solved for.
bool isRounded(const std::vector<Exhibit>& exhibits) {
  for (const Exhibit& e : exhibits)
    for (Eigen::Index k = 0; k < e.said.size() && e.failure.empty(); ++k) {
      const double x = e.said.data()[k];
      if (e.asked != Quantity::kQdd && static_cast<double>(static_cast<float>(x)) != x)
        return false;
    }
  return true;
}
/// Smaller errors than those of a float are no float's.
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

/// All that is wrong is so by no more than single precision loses.
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

/// What each mistake makes of the first answers, in units in which the whole misfit of each
/// quantity is of length 1.
class Sketches {
 public:
  explicit Sketches(const Case& all) : all_(all) {
    const VectorXd D = all.stacked(all.heads(), all.right(), false, true);
    truth_ = all.stacked(all.heads(), all.right(), true, true);
    weight_ = VectorXd::Zero(D.size());
    Eigen::Index at = 0;
    for (const Exhibit* e : all.heads()) {
      const Eigen::Index n = e->compared == Quantity::kM ? e->said.rows() : e->said.size();
      const double length = D.segment(at, n).norm();
      if (length > 0) weight_.segment(at, n).setConstant(1 / length);
      at += n;
    }
    aim_ = D.cwiseProduct(weight_);
  }
  /// Nothing: it makes something that is no number, or it makes nothing.
  std::optional<VectorXd> of(const Belief& belief) const {
    const VectorXd told = all_.stacked(all_.heads(), belief, true, true);
    if (!told.allFinite() || (told - truth_).cwiseAbs().maxCoeff() <= 1) return {};
    return VectorXd((told - truth_).cwiseProduct(weight_));
  }
  /// By no more than their limits.
  bool areOne(const VectorXd& a, const VectorXd& b) const {
    return ((a - b).cwiseAbs().array() <= weight_.array()).all();
  }
  const VectorXd& aim() const { return aim_; }

 private:
  const Case& all_;
  VectorXd truth_, weight_, aim_;
};

struct Candidate {
  const Hypothesis* hypothesis;
  std::vector<const Hypothesis*> all;  ///< that say the same first, this one included
  VectorXd sketch;
  double left;  ///< of the misfit
};

/// Those that change anything, each prediction once, the nearest first.
std::vector<Candidate> candidates(const Case& all, const Sketches& sketches,
                                  const std::vector<Hypothesis>& list) {
  std::vector<Candidate> out;
  for (const Hypothesis& h : list) {
    Belief belief = all.right();
    h.apply(belief);
    const std::optional<VectorXd> sketch = sketches.of(belief);
    if (!sketch) continue;
    const auto known = std::find_if(out.begin(), out.end(), [&](const Candidate& c) {
      return sketches.areOne(c.sketch, *sketch);
    });
    if (known != out.end()) {
      known->all.push_back(&h);
      continue;
    }
    const double heads = static_cast<double>(all.heads().size());
    out.push_back({&h, {&h}, *sketch, (sketches.aim() - *sketch).norm() / std::sqrt(heads)});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Candidate& a, const Candidate& b) { return a.left < b.left; });
  return out;
}

/// A number, by how much what is said first changes with it.
struct Slope {
  const Suspect* suspect;
  VectorXd direction;  ///< of length 1
};
std::vector<Slope> slopes(const Case& all, const Sketches& sketches,
                          const std::vector<Suspect>& numbers) {
  std::vector<Slope> out;
  const double step = std::sqrt(kEps);  // what differences lose and what rounding does are alike
  for (const Suspect& suspect : numbers) {
    if (suspect.names.size() != 1) continue;
    Belief belief = all.right();
    suspect.apply(belief, VectorXd::Constant(1, step * suspect.scale[0]));
    if (const auto sketch = sketches.of(belief)) out.push_back({&suspect, sketch->normalized()});
  }
  return out;
}

/// Two of something, and how far they are from the whole misfit when their effects are added up.
struct Two {
  double left;
  int first, second;
};
/// The nearest of them, in order.
void keepNearest(std::vector<Two>& list, long most) {
  const auto nearer = [](const Two& a, const Two& b) {
    return std::tie(a.left, a.first, a.second) < std::tie(b.left, b.first, b.second);
  };
  if (static_cast<long>(list.size()) > most) {
    std::nth_element(list.begin(), list.begin() + most, list.end(), nearer);
    list.resize(static_cast<std::size_t>(most));
  }
  std::sort(list.begin(), list.end(), nearer);
}
MatrixXd columns(const std::vector<Candidate>& list) {
  MatrixXd out(list.empty() ? 0 : list.front().sketch.size(), list.size());
  for (std::size_t i = 0; i < list.size(); ++i)
    out.col(static_cast<Eigen::Index>(i)) = list[i].sketch;
  return out;
}

/// @return whether the two explain the answers
bool addPair(const Case& all, const Hypothesis& a, const Hypothesis& b, Search& out) {
  // of two at one link it may matter which comes first
  const bool ordered = a.link >= 0 && a.link == b.link;
  bool explains = false;
  for (const bool forward : {true, false}) {
    if (!forward && !ordered) break;
    const Hypothesis &first = forward ? a : b, &second = forward ? b : a;
    Belief belief = all.right();
    first.apply(belief);
    second.apply(belief);
    const auto misfit = all.whole(belief);
    if (!misfit) continue;
    explains = true;
    out.found.push_back(findingOf(all, belief, {wordsOf(first), wordsOf(second)}, *misfit));
  }
  return explains;
}

void addPairs(const Case& all, const Sketches& sketches, const std::vector<Candidate>& list,
              Search& out) {
  const auto n = static_cast<int>(list.size());
  out.pairs += n * (n - 1L) / 2;
  const MatrixXd S = columns(list), R = (-S).colwise() + sketches.aim();
  const MatrixXd G = R.transpose() * S;
  const VectorXd r = R.colwise().squaredNorm(), t = S.colwise().squaredNorm();
  std::vector<Two> added, composed;
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) added.push_back({r(i) + t(j) - 2 * G(i, j), i, j});
  keepNearest(added, kMostPairs / 2);
  // effects that do not add up: one of the two comes near alone
  std::set<std::pair<int, int>> known;
  for (const Two& two : added) known.insert({two.first, two.second});
  for (int i = 0; i < n && static_cast<long>(composed.size()) < kMostPairs / 2; ++i)
    for (int j = i + 1; j < n; ++j)
      if (known.count({i, j}) == 0) composed.push_back({0, i, j});
  added.insert(added.end(), composed.begin(), composed.end());
  for (const Two& two : added) {
    ++out.pairs_tried;
    const Candidate &one = list[static_cast<std::size_t>(two.first)],
                    &other = list[static_cast<std::size_t>(two.second)];
    if (!addPair(all, *one.hypothesis, *other.hypothesis, out)) continue;
    for (const Hypothesis* a : one.all)
      for (const Hypothesis* b : other.all)
        if (a != one.hypothesis || b != other.hypothesis) addPair(all, *a, *b, out);
  }
}

/// A mistake, and a number that is another one.
void addPairsWithEstimates(const Case& all, const Sketches& sketches,
                           const std::vector<Candidate>& list, const std::vector<Slope>& numbers,
                           Search& out) {
  const std::vector<const Exhibit*> head = {all.heads().front()};
  out.pairs += static_cast<long>(list.size() * numbers.size());
  std::vector<Two> near;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const VectorXd rest = sketches.aim() - list[i].sketch;
    for (std::size_t j = 0; j < numbers.size(); ++j)
      near.push_back({rest.squaredNorm() - std::pow(rest.dot(numbers[j].direction), 2),
                      static_cast<int>(i), static_cast<int>(j)});
  }
  keepNearest(near, kMostPairsWithEstimates);
  for (const Two& two : near) {
    const Candidate& candidate = list[static_cast<std::size_t>(two.first)];
    const Hypothesis& h = *candidate.hypothesis;
    const Suspect& suspect = *numbers[static_cast<std::size_t>(two.second)].suspect;
    Belief base = all.right();
    h.apply(base);
    ++out.pairs_tried;
    VectorXd uncertainty;
    if (!estimated(all, head, base, suspect, &uncertainty, true)) continue;
    const auto added = estimated(all, all.primary(), base, suspect, &uncertainty);
    if (!added) continue;
    for (const Hypothesis* same : candidate.all) {
      Belief belief = all.right();
      same->apply(belief);
      suspect.apply(belief, *added);
      if (const auto misfit = all.whole(belief))
        out.found.push_back(findingOf(
            all, belief, {wordsOf(*same), wordsOf(suspect, *added, uncertainty)}, *misfit));
    }
  }
}

/// Two numbers that are others.
void addPairsOfEstimates(const Case& all, const Sketches& sketches,
                         const std::vector<Slope>& numbers, Search& out) {
  const auto n = static_cast<int>(numbers.size());
  out.pairs += n * (n - 1L) / 2;
  std::vector<Two> near;
  const double whole = sketches.aim().squaredNorm();
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      const VectorXd &a = numbers[static_cast<std::size_t>(i)].direction,
                     &b = numbers[static_cast<std::size_t>(j)].direction;
      const VectorXd across = b - a.dot(b) * a;
      if (!(across.norm() > kEps)) continue;
      near.push_back({whole - std::pow(sketches.aim().dot(a), 2) -
                          std::pow(sketches.aim().dot(across.normalized()), 2),
                      i, j});
    }
  keepNearest(near, kMostPairsOfEstimates);
  for (const Two& two : near) {
    const Suspect &a = *numbers[static_cast<std::size_t>(two.first)].suspect,
                  &b = *numbers[static_cast<std::size_t>(two.second)].suspect;
    Suspect both = a;
    both.is_linear = false;
    both.names.push_back(b.names[0]);
    both.scene.push_back(b.scene[0]);
    both.scale.push_back(b.scale[0]);
    both.apply = [&a, &b](Belief& belief, const VectorXd& added) {
      a.apply(belief, added.head(1));
      b.apply(belief, added.tail(1));
    };
    ++out.pairs_tried;
    VectorXd uncertainty;
    const auto first = estimated(all, all.heads(), all.right(), both, &uncertainty);
    if (!first) continue;
    Belief belief = all.right();
    both.apply(belief, *first);
    constexpr double kNear = 1e6;  // limits: what Newton left is refined below, or was not it
    if (!(all.stacked(all.heads(), belief, false).cwiseAbs().maxCoeff() < kNear)) continue;
    const auto added = estimated(all, all.primary(), all.right(), both, &uncertainty);
    if (!added) continue;
    belief = all.right();
    both.apply(belief, *added);
    if (const auto misfit = all.whole(belief))
      out.found.push_back(findingOf(all, belief,
                                    {wordsOf(a, added->head(1), uncertainty.head(1)),
                                     wordsOf(b, added->tail(1), uncertainty.tail(1))},
                                    *misfit));
  }
}

std::vector<CheckFinding> nearest(const std::vector<Candidate>& list) {
  std::vector<CheckFinding> out;
  for (const Candidate& c : list) {
    if (out.size() == kNearest || !(c.left < 1)) break;
    CheckFinding finding;
    finding.parts = {wordsOf(*c.hypothesis)};
    finding.left = c.left;
    out.push_back(finding);
  }
  return out;
}

/// The best first; of findings of the same rule at the same place the first; and which of them
/// nobody can tell from the first.
std::vector<CheckFinding> inOrder(const Case& all, std::vector<Found> found) {
  const auto rank = [](const Found& f) {
    return std::make_pair(f.finding.unasked.size(), f.finding.spared.size());
  };
  std::stable_sort(found.begin(), found.end(),
                   [&](const Found& a, const Found& b) { return rank(a) < rank(b); });
  const auto key = [](const CheckFinding& f) {
    std::string out;
    for (const Explanation& part : f.parts)
      out += fmt::format("{} {} {};", part.rule, part.link, part.at_joint);
    return out;
  };
  std::vector<CheckFinding> kept;
  for (Found& f : found) {
    if (std::any_of(kept.begin(), kept.end(),
                    [&](const CheckFinding& k) { return key(k) == key(f.finding); }))
      continue;
    if (!kept.empty())
      f.finding.is_first = rank(f) == rank(found.front()) &&
                           f.finding.spared == found.front().finding.spared &&
                           all.areOne(f.belief, found.front().belief);
    kept.push_back(f.finding);
  }
  return kept;
}

/// Whether it leaves nothing to be explained, and takes nothing for wrong that is right.
bool isClean(const Search& search) {
  return std::any_of(search.found.begin(), search.found.end(), [](const Found& f) {
    return f.finding.unasked.empty() && f.finding.spared.empty();
  });
}

}  // namespace

Explained explained(const TextbookModel& model, const std::vector<Exhibit>& given,
                    const std::vector<scene::State<double>>& chosen) {
  Explained out;
  const bool rounded = isRounded(given);
  std::vector<Exhibit> exhibits = given, coarse;  // coarse: with the limits of single precision
  for (Exhibit& e : exhibits) {
    coarse.push_back(e);
    coarse.back().bound = kSingle * e.sweep_bound;
    coarse.back().is_wrong = (e.error.array() > kSingle * e.bound.array()).any();
    e.bound = e.sweep_bound;
  }
  const std::vector<Hypothesis> list = hypotheses(model);
  const std::vector<Suspect> numbers = suspects(model);
  const scene::Work work("hypotheses", 4);
  Search search;
  std::size_t looked_at = 0;
  for (const Scope scope : {Scope::kAll, Scope::kForces}) {
    const Case all(model, exhibits, chosen, scope);
    if (all.primary().empty() || all.primary().size() == looked_at) continue;
    looked_at = all.primary().size();
    // so near to the limit that no mistake at all explains it as well as any
    if (all.whole(all.right())) continue;
    addSingles(all, list, search);
    if (!isClean(search)) addEstimates(all, numbers, search);
    if (search.found.empty()) addSingle(all, rounded, search);
    const auto addBesideSingle = [&] {  // something else, and single precision
      const Case in_single(model, coarse, chosen, scope);
      if (in_single.primary().empty()) return;
      addSingles(in_single, list, search);
      if (search.found.empty()) addEstimates(in_single, numbers, search);
      std::vector<Found>& found = search.found;
      found.erase(std::remove_if(found.begin(), found.end(),
                                 [&](const Found& f) {
                                   return !isOfSingle(f.finding.residual_relative, rounded);
                                 }),
                  found.end());
      for (Found& f : found) f.finding.parts.push_back(singlePrecision(rounded));
    };
    if (search.found.empty() && rounded) addBesideSingle();
    if (search.found.empty()) {
      const Sketches sketches(all);
      const std::vector<Candidate> near = candidates(all, sketches, list);
      const std::vector<Slope> sloping = slopes(all, sketches, numbers);
      addPairs(all, sketches, near, search);
      if (search.found.empty()) addPairsWithEstimates(all, sketches, near, sloping, search);
      if (search.found.empty()) addPairsOfEstimates(all, sketches, sloping, search);
      if (search.found.empty()) out.findings = nearest(near);
    }
    if (search.found.empty()) continue;
    out.findings = inOrder(all, std::move(search.found));
    break;
  }
  out.tried = search.tried;
  out.pairs = search.pairs;
  out.pairs_tried = search.pairs_tried;
  return out;
}

}  // namespace dynwitness::crosscheck
