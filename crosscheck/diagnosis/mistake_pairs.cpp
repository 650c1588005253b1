// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/mistake_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "crosscheck/diagnosis/estimated_number.hpp"

namespace dynwitness::crosscheck::explaining {
namespace {

/// Pairs that are looked at, at most: the nearest, when the effects of the two are added up.
constexpr long kMostPairs = 100'000;
constexpr long kMostPairsWithEstimates = 40'000;
constexpr long kMostPairsOfEstimates = 500;
constexpr std::size_t kNearest = 5;  ///< that are told where none explains

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

void addPairsOfMistakes(const Case& all, const Sketches& sketches,
                        const std::vector<Candidate>& list, Search& out) {
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

}  // namespace

std::vector<CheckFinding> addPairs(const Case& all, const std::vector<Hypothesis>& list,
                                   const std::vector<Suspect>& numbers, Search& out) {
  const Sketches sketches(all);
  const std::vector<Candidate> near = candidates(all, sketches, list);
  const std::vector<Slope> sloping = slopes(all, sketches, numbers);
  addPairsOfMistakes(all, sketches, near, out);
  if (out.found.empty()) addPairsWithEstimates(all, sketches, near, sloping, out);
  if (out.found.empty()) addPairsOfEstimates(all, sketches, sloping, out);
  return out.found.empty() ? nearest(near) : std::vector<CheckFinding>();
}

}  // namespace dynwitness::crosscheck::explaining
