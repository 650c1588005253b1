// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/acceleration.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "crosscheck/reduction/acceleration_boxes.hpp"
#include "crosscheck/reduction/acceleration_error.hpp"
#include "crosscheck/reduction/corners.hpp"
#include "crosscheck/reduction/polynomial_table.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using scene::JointRanges;
using scene::Range;
using ErrorMatrix = Eigen::Matrix<RunningError, Eigen::Dynamic, Eigen::Dynamic>;
using ErrorVector = Eigen::Matrix<RunningError, Eigen::Dynamic, 1>;

constexpr std::size_t kMostCorners = 20000;  ///< remembered at a time: 160 MB for seven joints

double norm(const ErrorMatrix& m) {
  double squares = 0;
  for (Index k = 0; k < m.size(); ++k) squares += std::pow(most(m.data()[k]), 2);
  return std::sqrt(squares) * (1 + kLost);
}

/// L^-1 of M = L L'; none (no rows): M is not positive definite for all that is known of it.
ErrorMatrix inverseFactor(const ErrorMatrix& M) {
  const Index n = M.rows();
  ErrorMatrix L = ErrorMatrix::Zero(n, n), inverse = L;
  for (Index j = 0; j < n; ++j)
    for (Index i = j; i < n; ++i) {
      RunningError sum = M(i, j);
      for (Index k = 0; k < j; ++k) sum -= L(i, k) * L(j, k);
      if (i == j && !(sum.value() > sum.bound())) return {};
      L(i, j) = i == j ? sqrt(sum) : sum / L(j, j);
    }
  for (Index c = 0; c < n; ++c)
    for (Index i = c; i < n; ++i) {
      RunningError sum = i == c ? 1 : 0;
      for (Index k = c; k < i; ++k) sum -= L(i, k) * inverse(k, c);
      inverse(i, c) = sum / L(i, i);
    }
  return inverse;
}

/// What is known at one corner in q; bounds are upwards.
struct Corner {
  ErrorMatrix rows;     ///< of M^-1
  ErrorMatrix answers;  ///< y, by column one a source
  VectorXd inverse;     ///< (M^-1)_jj; none: M may have no inverse
  MatrixXd norms;       ///< of sources, by column of the table
  VectorXd relative;    ///< of M' and M'', by column of the table
};

class AccelerationSearch : AccelerationBoxes {
 public:
  AccelerationSearch(const TrigonometricModel& model, const std::vector<JointRanges>& ranges)
      : AccelerationBoxes(model, ranges), table_(model, ranges, listed()) {}

  /// Of |qdd_i|; the rest as BoundedQuantity::over().
  EnvelopeBound over(int i, const std::vector<JointRanges>& box, const EnvelopeOptions& options,
                     double decide) {
    ranges_ = &box;
    return search(
        nothingKnown(i), table_.active(), options, decide, [&](Box* part) { judge(part); },
        [&](const std::vector<double>& q, const Box& part) { return seenAt(q, part); });
  }

 private:
  /// The largest of viscous and dry friction at a joint.
  double mostOfFriction(Index j, const Range& qd) const {
    return most(of(model_.viscous, j)) * qd.most() +
           std::max(most(of(model_.positive, j)), most(of(model_.negative, j)));
  }

  /// Upper triangle of M, then the sources: g and loads, and the products of rates.
  std::vector<Polynomial> listed() {
    std::vector<Polynomial> all;
    for (std::size_t a = 0; a < model_.M.size(); ++a)
      for (std::size_t b = a; b < model_.M.size(); ++b) all.push_back(model_.M[a][b]);
    sources_.assign(1, {-1, -1, static_cast<Index>(all.size())});
    for (std::size_t j = 0; j < model_.M.size(); ++j) {
      all.push_back(model_.gravity[j]);
      add(model_.loads[j], 1, &all.back());
    }
    for (const auto& [pair, column] : rateProducts(model_)) {
      sources_.push_back({pair.first, pair.second, static_cast<Index>(all.size())});
      all.insert(all.end(), column.begin(), column.end());
    }
    return all;
  }
  Index placeOf(Index a, Index b) const {
    if (a > b) std::swap(a, b);
    return a * n_ - a * (a - 1) / 2 + b - a;
  }

  const Corner& corner(const std::vector<double>& q) {
    return corners_.at(q, [this](const std::vector<double>& at) { return computed(at); });
  }

  Corner computed(const std::vector<double>& q) const {
    const MatrixXd values = table_.at(q);
    const auto entry = [&](Index row, Index o) {
      return RunningError(values(row, o), table_.lost()(row, o));
    };
    const auto matrix = [&](Index o) {
      ErrorMatrix M(n_, n_);
      for (Index a = 0; a < n_; ++a)
        for (Index b = 0; b < n_; ++b) M(a, b) = entry(placeOf(a, b), o);
      return M;
    };
    Corner out;
    const ErrorMatrix L = inverseFactor(matrix(0));
    if (L.rows() == 0) return out;
    out.inverse.resize(n_);
    for (Index j = 0; j < n_; ++j) out.inverse(j) = std::pow(norm(L.col(j)), 2) * (1 + kLost);
    out.rows = L.transpose() * L;
    const auto count = static_cast<Index>(sources_.size());
    out.norms.resize(count, table_.columns());
    out.answers.resize(n_, count);
    for (Index s = 0; s < count; ++s)
      for (Index o = 0; o < table_.columns(); ++o) {
        ErrorVector column(n_);
        for (Index j = 0; j < n_; ++j)
          column(j) = entry(sources_[static_cast<std::size_t>(s)].first + j, o);
        if (s == 0) addSprings(q, o, &column);
        out.norms(s, o) = norm(L * column);
        if (o == 0) out.answers.col(s) = out.rows * column;
      }
    out.relative.setZero(table_.columns());
    for (Index o = 1; o < table_.columns(); ++o)
      out.relative(o) = norm(L * matrix(o) * L.transpose());
    return out;
  }

  /// k (q - rest), and its derivative.
  void addSprings(const std::vector<double>& q, Index o, ErrorVector* column) const {
    for (std::size_t k = 0; k < q.size(); ++k) {
      const Index j = table_.active()[k];
      if (o == 0)
        (*column)(j) += of(model_.stiffness, j) * (RunningError(q[k]) - of(model_.rest, j));
      if (o == 1 + static_cast<Index>(k)) (*column)(j) += of(model_.stiffness, j);
    }
  }

  void judge(Box* box) {
    Corner worst;  // by entry
    worst.inverse = VectorXd::Zero(n_);
    worst.norms = MatrixXd::Zero(static_cast<Index>(sources_.size()), table_.columns());
    worst.relative = VectorXd::Zero(table_.columns());
    VectorXd concave = VectorXd::Zero(n_);
    double largest = 0, rho = 0;
    const bool are_all = forCorners(*box, [&](std::size_t, const std::vector<double>& q) {
      const Corner& at_q = corner(q);
      if (at_q.inverse.size() == 0) return false;
      rho = std::max(rho, rest(at_q.inverse, *box, 0));
      worst.inverse = worst.inverse.cwiseMax(at_q.inverse);
      worst.norms = worst.norms.cwiseMax(at_q.norms);
      worst.relative = worst.relative.cwiseMax(at_q.relative);
      for (std::size_t s = 1; s < sources_.size(); ++s)
        if (sources_[s].a == sources_[s].b)
          concave(sources_[s].a) =
              std::max(concave(sources_[s].a), most(at_q.answers(i_, static_cast<Index>(s))));
      largest = std::max(largest, largestAt(at_q, q, *box).bound);
      return true;
    });
    if (!are_all) return haveNoBound(VectorXd::Ones(n_), box);
    if (!(rho * (1 + kLost) < 1)) return haveNoBound(worst.inverse, box);
    widen(rho * (1 + kLost), *box, &worst);
    addBetween(worst, concave, largest, box);
  }

  /// What R of column o of M is at most, relative to M: what is unknown at corners and inside, and
  /// what each active joint adds.
  double rest(const VectorXd& inverse, const Box& box, Index o) const {
    double unknown = 0;
    for (Index a = 0; a < n_; ++a)
      for (Index b = 0; b < n_; ++b)
        unknown += 2 * table_.lost()(placeOf(a, b), o) * std::sqrt(inverse(a) * inverse(b));
    return unknown + shares(inverse, box, o).sum();
  }
  VectorXd shares(const VectorXd& inverse, const Box& box, Index o) const {
    VectorXd out = VectorXd::Zero(static_cast<Index>(box.q.size()));
    for (std::size_t l = 0; l < box.q.size(); ++l)
      for (Index a = 0; a < n_; ++a)
        for (Index b = 0; b < n_; ++b)
          out(static_cast<Index>(l)) += 0.5 * std::pow(half(box.q[l]), 2) *
                                        table_.beyond(l)(placeOf(a, b), o) *
                                        std::sqrt(inverse(a) * inverse(b));
    return out;
  }

  void haveNoBound(const VectorXd& inverse, Box* box) const {
    box->bound = HUGE_VAL;
    box->split = -1;
    const VectorXd shares_of = shares(inverse, *box, 0);
    Index most = 0;
    if (shares_of.size() > 0 && shares_of.maxCoeff(&most) > 0) box->split = static_cast<int>(most);
  }

  /// From the corners to all between them, (3).
  void widen(double rho, const Box& box, Corner* worst) const {
    worst->inverse /= 1 - rho;
    const VectorXd roots = worst->inverse.cwiseSqrt();
    worst->relative /= 1 - rho;
    worst->norms /= std::sqrt(1 - rho);
    for (Index o = 0; o < table_.columns(); ++o) {
      worst->relative(o) += rest(worst->inverse, box, o);
      for (std::size_t s = 0; s < sources_.size(); ++s) {
        const Index first = sources_[s].first;
        double& norm = worst->norms(static_cast<Index>(s), o);
        norm += 2 * table_.lost().col(o).segment(first, n_).dot(roots);
        for (std::size_t l = 0; l < box.q.size(); ++l)
          norm += 0.5 * std::pow(half(box.q[l]), 2) *
                  table_.beyond(l).col(o).segment(first, n_).dot(roots);
      }
    }
  }

  double seenAt(const std::vector<double>& q, const Box& box) {
    const Corner at_q = computed(q);
    return at_q.inverse.size() == 0 ? 0 : largestAt(at_q, q, box).seen;
  }

  /// The largest |qdd_i| at a corner in q: a bound, and what is surely reached.
  struct AtCorner {
    double bound = 0, seen = 0;
  };
  AtCorner largestAt(const Corner& at_q, const std::vector<double>& q, const Box& box) {
    MatrixXd form = MatrixXd::Zero(n_, n_);
    double lost = at_q.answers(i_, 0).bound();
    for (std::size_t s = 1; s < sources_.size(); ++s) {
      const RunningError& y = at_q.answers(i_, static_cast<Index>(s));
      lost += y.bound() * mostOf(sources_[s]);
      form(sources_[s].b, sources_[s].a) = -y.value();
    }
    VectorXd row(n_);
    for (Index j = 0; j < n_; ++j) {
      const RunningError& r = at_q.rows(i_, j);
      row(j) = r.value();
      lost += r.bound() * (at(j).tau->most() + mostOfFriction(j, at(j).qd)) +
              std::abs(row(j)) * (of(model_.positive, j).bound() + of(model_.negative, j).bound()) +
              (r * of(model_.viscous, j)).bound() * at(j).qd.most();
    }
    AtCorner out;
    for (const int sign : {1, -1}) {
      const Largest of_sign = largest(row, -at_q.answers(i_, 0).value(), form, box, sign);
      const double lost_here = (lost + kLost * std::abs(of_sign.value)) * (1 + kLost);
      lost_most_ = std::max(lost_most_, lost_here);
      out.seen = std::max(out.seen, remember(row, q, of_sign.qd, sign, of_sign.value - lost_here));
      out.bound = std::max(out.bound, of_sign.value + of_sign.dry + lost_here);
    }
    return out;
  }

  /// What lies between the corners, by variable: (2).
  void addBetween(const Corner& worst, const VectorXd& concave, double largest, Box* box) const {
    const auto m = static_cast<Index>(box->q.size());
    VectorXd adds(m + n_);
    for (Index k = 0; k < m; ++k) {
      const double mu = worst.relative(1 + k), nu = worst.relative(1 + m + k);
      double sum = 0;
      for (Index j = 0; j < n_; ++j)  // the columns of tau: constant
        sum += (at(j).tau->most() + mostOfFriction(j, box->qd[static_cast<std::size_t>(j)])) *
               std::sqrt(worst.inverse(j)) * (2 * mu * mu + nu);
      for (std::size_t s = 0; s < sources_.size(); ++s) {
        const auto row = static_cast<Index>(s);
        const double weight = s == 0 ? 1 : mostOf(sources_[s], *box);
        sum += weight * (worst.norms(row, 1 + m + k) +
                         2 * mu * (worst.norms(row, 1 + k) + mu * worst.norms(row, 0)) +
                         nu * worst.norms(row, 0));
      }
      adds(k) = 0.5 * std::pow(half(box->q[static_cast<std::size_t>(k)]), 2) *
                std::sqrt(worst.inverse(i_)) * sum;
    }
    for (Index a = 0; a < n_; ++a)
      adds(m + a) = std::pow(half(box->qd[static_cast<std::size_t>(a)]), 2) * concave(a);
    box->bound = (largest + adds.sum()) * (1 + kLost);
    Index most = 0;
    box->split = adds.maxCoeff(&most) > 0 ? static_cast<int>(most) : -1;
  }

  struct Source {
    int a, b;     ///< of qd_a qd_b; -1: gravity, loads and springs
    Index first;  ///< its first row in the table
  };
  /// The largest that it is multiplied by, over all of the ranges and over a box in qd.
  double mostOf(const Source& s) const { return at(s.a).qd.most() * at(s.b).qd.most(); }
  static double mostOf(const Source& s, const Box& box) {
    return box.qd[static_cast<std::size_t>(s.a)].most() *
           box.qd[static_cast<std::size_t>(s.b)].most();
  }

  std::vector<Source> sources_;
  PolynomialTable table_;
  CornersKnown<Corner> corners_{kMostCorners};
};

/// Boxes of the first search, for each joint. What it finds is only put into the bounds of the
/// second one, where it stands beside small numbers; few, since they come on top.
constexpr int kFirstBoxes = 300;

}  // namespace

/// Two searches: by norms, which knows nothing, and by what is known of all joints by then.
class AccelerationBounds::Searches {
 public:
  Searches(const TrigonometricModel& model, const std::vector<JointRanges>& ranges)
      : model_(model), by_norms_(model, ranges) {}

  EnvelopeBound over(int i, const std::vector<JointRanges>& box, const EnvelopeOptions& options,
                     double decide) {
    EnvelopeOptions first = options;
    first.boxes = std::min(options.boxes, kFirstBoxes);
    take(box);
    EnvelopeBound& known = known_[static_cast<std::size_t>(i)];
    EnvelopeBound mine = known.boxes > 0 ? known : by_norms_.over(i, box_, first, decide);
    if (decide < 0) known = mine;
    if (isKnown(mine.certified, mine.sampled, options, decide) || options.boxes <= first.boxes)
      return mine;
    std::vector<double> certified;
    for (int j = 0; j < model_.dof; ++j) {
      EnvelopeBound& of_j = known_[static_cast<std::size_t>(j)];
      if (of_j.boxes == 0) of_j = by_norms_.over(j, box_, first, -1);
      if (!std::isfinite(of_j.certified)) return by_norms_.over(i, box_, options, decide);
      certified.push_back(of_j.certified);
    }
    if (!errors_) errors_ = std::make_unique<AccelerationErrors>(model_, box_);
    mine = errors_->better(mine, certified, options, decide);
    if (decide < 0) known = mine;
    return mine;
  }

 private:
  /// What is known of one box is kept until another is asked about.
  void take(const std::vector<JointRanges>& box) {
    const auto same = [](const Range& a, const Range& b) {
      return a.low == b.low && a.high == b.high;
    };
    if (std::equal(box.begin(), box.end(), box_.begin(), box_.end(),
                   [&](const JointRanges& a, const JointRanges& b) {
                     return same(a.q, b.q) && same(a.qd, b.qd) && same(*a.tau, *b.tau);
                   }))
      return;
    errors_.reset();
    box_ = box;
    known_.assign(box.size(), {});
  }

  const TrigonometricModel& model_;
  AccelerationSearch by_norms_;
  std::vector<JointRanges> box_;
  std::vector<EnvelopeBound> known_;  ///< by joint
  std::unique_ptr<AccelerationErrors> errors_;
};

AccelerationBounds::AccelerationBounds(const TrigonometricModel& model,
                                       const std::vector<JointRanges>& ranges)
    : searches_(std::make_unique<Searches>(model, ranges)) {}
AccelerationBounds::~AccelerationBounds() = default;

EnvelopeBound AccelerationBounds::over(int i, const std::vector<JointRanges>& box,
                                       const EnvelopeOptions& options, double decide) {
  return searches_->over(i, box, options, decide);
}

}  // namespace dynwitness::crosscheck
