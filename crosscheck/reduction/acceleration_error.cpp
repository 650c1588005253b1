// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/acceleration_error.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Cholesky>

#include "crosscheck/reduction/acceleration_boxes.hpp"
#include "crosscheck/reduction/corners.hpp"
#include "crosscheck/reduction/polynomial_table.hpp"
#include "crosscheck/reduction/reduced_acceleration.hpp"

namespace dynwitness::crosscheck {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using scene::JointRanges;
using scene::Range;

constexpr std::size_t kMostCorners = 4000;  ///< remembered at a time: 130 MB for six joints

/// What is known at one corner in q.
struct Corner {
  MatrixXd values;    ///< of the table
  MatrixXd vectors;   ///< (l, k) of every i, by column; of one model k; none: M or M_r is singular
  MatrixXd residual;  ///< |brackets of (2)| there, by column: roundings
};

}  // namespace

class AccelerationErrors::Search : AccelerationBoxes {
 public:
  /// @param reduced  null: (3)
  Search(const TrigonometricModel& full, const TrigonometricModel* reduced,
         const std::vector<JointRanges>& ranges, std::vector<double> accelerations)
      : AccelerationBoxes(full, ranges),
        reduced_(reduced),
        size_(reduced ? 2 * n_ : n_),
        accelerations_(std::move(accelerations)),
        table_(full, ranges, listed()) {
    const auto m = static_cast<std::size_t>(table_.active().size());
    for (Index o = 0; o < table_.columns(); ++o) {
      lost_.push_back(operatorOf(table_.lost().col(o)));
      largest_.push_back(operatorOf(table_.largest().col(o)));
    }
    beyond_.resize(m);
    mixed_.assign(m, std::vector<MatrixXd>(m));
    for (std::size_t l = 0; l < m; ++l)
      for (Index o = 0; o < table_.columns(); ++o)
        beyond_[l].push_back(operatorOf(table_.beyond(l).col(o)));
    for (std::size_t l = 0; l < m; ++l)
      for (std::size_t k = 0; k < l; ++k)
        mixed_[k][l] = mixed_[l][k] = operatorOf(table_.mixed(k, l));
    addSprings();
  }

  using AccelerationBoxes::nothingKnown;

  EnvelopeBound over(const EnvelopeBound& before, const std::vector<double>& within,
                     const EnvelopeOptions& options, double decide) {
    weights_.resize(1 + size_);
    weights_(0) = 1;
    weights_.segment(1, n_) = Eigen::Map<const VectorXd>(within.data(), n_);
    if (reduced_) weights_.tail(n_) = Eigen::Map<const VectorXd>(accelerations_.data(), n_);
    return search(
        before, table_.active(), options, decide, [&](Box* box) { judge(box); },
        [&](const std::vector<double>& q, const Box& box) { return seenAt(q, box); });
  }

 private:
  using CornerAt = std::shared_ptr<const Corner>;

  /// M_r, D and M, column by column; then of each source d and h. Of one model M and h.
  std::vector<Polynomial> listed() {
    std::vector<Polynomial> all;
    const auto addMatrix = [&](const TrigonometricModel& model) {
      for (std::size_t b = 0; b < model.M.size(); ++b)
        for (std::size_t a = 0; a < model.M.size(); ++a) all.push_back(model.M[a][b]);
    };
    RateProducts full = rateProducts(model_), off;
    sources_.assign(1, {-1, -1});
    if (reduced_) {
      const TrigonometricModel d = difference(*reduced_, model_);
      addMatrix(*reduced_);
      addMatrix(d);
      addMatrix(model_);
      all.insert(all.end(), d.gravity.begin(), d.gravity.end());
      off = rateProducts(d);
      for (const auto& [pair, column] : off) full[pair].resize(column.size());
    } else {
      addMatrix(model_);
    }
    for (std::size_t j = 0; j < model_.gravity.size(); ++j) {
      all.push_back(model_.gravity[j]);
      add(model_.loads[j], 1, &all.back());
    }
    for (const auto& [pair, column] : full) {
      sources_.push_back(pair);
      if (reduced_) off[pair].resize(column.size());
      for (const Polynomial& f : off[pair]) all.push_back(f);
      all.insert(all.end(), column.begin(), column.end());
    }
    most_.resize(static_cast<Index>(sources_.size()));
    for (Index s = 0; s < most_.size(); ++s) {
      const auto& [a, b] = sources_[static_cast<std::size_t>(s)];
      most_(s) = s == 0 ? 1 : at(a).qd.most() * at(b).qd.most();
    }
    return all;
  }

  template <typename Column>
  Eigen::Map<const MatrixXd> sources(const Column& column) const {
    return {column.data() + (reduced_ ? 3 : 1) * n_ * n_, size_, most_.size()};
  }
  /// Of magnitudes: what multiplies (l, k) in (2): the forces, each with the most that rates make
  /// of it, and both brackets; k and one bracket in (3).
  template <typename Column>
  MatrixXd operatorOf(const Column& column) const {
    MatrixXd out = MatrixXd::Zero(1 + size_, size_);
    const VectorXd contiguous = column;
    out.row(0) = (sources(contiguous) * most_).transpose();
    out.block(1, 0, n_, n_) = Eigen::Map<const MatrixXd>(contiguous.data(), n_, n_);
    if (reduced_)
      out.bottomRows(n_) = Eigen::Map<const MatrixXd>(contiguous.data() + n_ * n_, n_, size_);
    return out;
  }

  /// Springs, k (q - rest), are forces of both: in h alone.
  void addSprings() {
    for (std::size_t k = 0; k < table_.active().size(); ++k) {
      const Index j = table_.active()[k];
      const double stiffness = most(of(model_.stiffness, j));
      const double stretch = at(j).q.most() + most(of(model_.rest, j));
      lost_[0](0, size_ - n_ + j) += of(model_.stiffness, j).bound() * stretch +
                                     stiffness * (of(model_.rest, j).bound() + kLost * stretch);
      lost_[1 + k](0, size_ - n_ + j) += of(model_.stiffness, j).bound();
      largest_[0](0, size_ - n_ + j) += stiffness * stretch;
      largest_[1 + k](0, size_ - n_ + j) += stiffness;
    }
  }

  CornerAt corner(const std::vector<double>& q) {
    return corners_.at(q, [this](const std::vector<double>& at) { return computed(at); });
  }

  CornerAt computed(const std::vector<double>& q) const {
    auto out = std::make_shared<Corner>();
    out->values = table_.at(q);
    for (std::size_t k = 0; k < q.size(); ++k) {
      const Index j = table_.active()[k];
      const Index row = (reduced_ ? 3 : 1) * n_ * n_ + size_ - n_ + j;
      const double stiffness = of(model_.stiffness, j).value();
      out->values(row, 0) += stiffness * (q[k] - of(model_.rest, j).value());
      out->values(row, 1 + static_cast<Index>(k)) += stiffness;
    }
    const auto matrix = [&](Index b) {
      return Eigen::Map<const MatrixXd>(out->values.data() + b * n_ * n_, n_, n_);
    };
    const Eigen::LLT<MatrixXd> full(matrix(reduced_ ? 2 : 0));
    const MatrixXd unit = MatrixXd::Identity(n_, n_);
    MatrixXd vectors(size_, n_), to = -unit;  // D l
    if (reduced_) {
      const Eigen::LLT<MatrixXd> reduced(matrix(0));
      if (reduced.info() != Eigen::Success) return out;
      vectors.topRows(n_) = reduced.solve(unit);
      to = matrix(1) * vectors.topRows(n_);
    }
    vectors.bottomRows(n_) = -full.solve(to);
    if (full.info() != Eigen::Success || !vectors.allFinite()) return out;
    out->residual.setZero(1 + size_, n_);
    if (reduced_)
      out->residual.middleRows(1, n_) = (unit - matrix(0) * vectors.topRows(n_)).cwiseAbs();
    out->residual.bottomRows(n_) =
        (to + matrix(reduced_ ? 2 : 0) * vectors.bottomRows(n_)).cwiseAbs();
    out->vectors = vectors;
    return out;
  }

  void judge(Box* box) {
    std::vector<CornerAt> corners(std::size_t{1} << box->q.size());  // by their ends; none: again
    VectorXd mean = VectorXd::Zero(size_), residual = VectorXd::Zero(1 + size_);
    const bool are_all = forCorners(*box, [&](std::size_t ends, const std::vector<double>& q) {
      corners[ends] = corner(q);
      if (corners[ends]->vectors.size() == 0) return false;
      mean = mean.cwiseMax(corners[ends]->vectors.col(i_).cwiseAbs());
      residual = residual.cwiseMax(corners[ends]->residual.col(i_));
      return true;
    });
    if (!are_all) return haveNoBound(box);
    const double lost = lostAt(mean, residual);
    double largest = 0;
    VectorXd concave = VectorXd::Zero(n_);
    forCorners(*box, [&](std::size_t ends, const std::vector<double>& q) {
      largest = std::max(largest, largestAt(*corners[ends], q, *box, lost, &concave).bound);
      return true;
    });
    addBetween(corners, mean, concave, largest + lost, box);
  }

  /// What is seen at one q.
  double seenAt(const std::vector<double>& q, const Box& box) {
    const CornerAt c = computed(q);
    if (c->vectors.size() == 0) return 0;
    VectorXd concave = VectorXd::Zero(n_);
    const double lost = lostAt(c->vectors.col(i_).cwiseAbs(), c->residual.col(i_));
    return largestAt(*c, q, box, lost, &concave).seen;
  }

  /// Of the forces in (2) and of the brackets, where (l, k) is at most `mean`.
  double lostAt(const VectorXd& mean, const VectorXd& residual) {
    double out = 2 * lost_[0].row(0).dot(mean) + weights_.dot(residual + 4 * lost_[0] * mean);
    for (Index j = 0; j < n_; ++j)
      out += mean(size_ - n_ + j) *
             (of(model_.positive, j).bound() + of(model_.negative, j).bound() +
              of(model_.viscous, j).bound() * at(j).qd.most() +
              kLost * (at(j).tau->most() + most(of(model_.viscous, j)) * at(j).qd.most() +
                       most(of(model_.positive, j)) + most(of(model_.negative, j))));
    lost_most_ = std::max(lost_most_, out);
    return out;
  }

  /// Parted where it is widest, in rad or m.
  void haveNoBound(Box* box) const {
    box->bound = HUGE_VAL;
    box->split = -1;
    double widest = 0;
    for (std::size_t k = 0; k < box->q.size(); ++k)
      if (half(box->q[k]) > widest) {
        widest = half(box->q[k]);
        box->split = static_cast<int>(k);
      }
  }

  /// The largest |e_i| at a corner in q: a bound but for `lost`, and what is surely reached.
  struct AtCorner {
    double bound = 0, seen = 0;
  };
  AtCorner largestAt(const Corner& c, const std::vector<double>& q, const Box& box, double lost,
                     VectorXd* concave) {
    const VectorXd v = c.vectors.col(i_), row = v.tail(n_);
    const VectorXd answers = -(sources(c.values.col(0)).transpose() * v);
    MatrixXd form = MatrixXd::Zero(n_, n_);
    for (std::size_t s = 1; s < sources_.size(); ++s) {
      const double y = answers(static_cast<Index>(s));
      form(sources_[s].second, sources_[s].first) = y;
      if (sources_[s].first == sources_[s].second)
        (*concave)(sources_[s].first) = std::max((*concave)(sources_[s].first), std::abs(y));
    }
    AtCorner out;
    for (const int sign : {1, -1}) {
      const Largest of_sign = largest(row, answers(0), form, box, sign);
      const double rounded = kLost * std::abs(of_sign.value);
      out.seen =
          std::max(out.seen, remember(row, q, of_sign.qd, sign, of_sign.value - lost - rounded));
      out.bound = std::max(out.bound, of_sign.value + of_sign.dry + rounded);
    }
    return out;
  }

  /// How l and k change in a box: the largest of their magnitudes and divided differences.
  struct Slopes {
    VectorXd mean;
    std::vector<VectorXd> first;
    std::vector<std::vector<VectorXd>> second;
  };
  Slopes slopesOf(const std::vector<CornerAt>& corners, const Box& box,
                  const VectorXd& mean) const {
    const std::size_t m = box.q.size();
    const VectorXd none = VectorXd::Zero(size_);
    Slopes out{mean, {}, std::vector<std::vector<VectorXd>>(m, std::vector<VectorXd>(m, none))};
    const auto v = [&](std::size_t bits) { return corners[bits]->vectors.col(i_); };
    for (std::size_t k = 0; k < m; ++k) {
      const double width = 2 * half(box.q[k]);
      VectorXd first = none;
      for (std::size_t bits = 0; width > 0 && bits < corners.size(); ++bits) {
        if (!corners[bits] || (bits >> k & 1) != 0) continue;
        const std::size_t up = bits | std::size_t{1} << k;
        first = first.cwiseMax((v(up) - v(bits)).cwiseAbs() / width);
        for (std::size_t l = 0; l < k; ++l) {
          const double other = 2 * half(box.q[l]);
          if ((bits >> l & 1) != 0 || other == 0) continue;
          const std::size_t l_up = std::size_t{1} << l;
          out.second[k][l] = out.second[k][l].cwiseMax(
              (v(up | l_up) - v(up) - v(bits | l_up) + v(bits)).cwiseAbs() / (width * other));
        }
      }
      for (std::size_t l = 0; l < k; ++l) out.second[l][k] = out.second[k][l];
      out.first.push_back(first);
    }
    return out;
  }

  /// |second derivatives by active joint k| of the forces and both brackets at corners: the most.
  VectorXd curvature(const std::vector<CornerAt>& corners, const Box& box, std::size_t k) const {
    const auto m = static_cast<Index>(box.q.size()), o = 1 + static_cast<Index>(k);
    const double width = 2 * half(box.q[k]);
    VectorXd out = VectorXd::Zero(1 + size_);
    for (std::size_t bits = 0; bits < corners.size(); ++bits) {
      if (!corners[bits]) continue;
      const Corner& c = *corners[bits];
      const std::size_t bit = std::size_t{1} << k;
      const VectorXd v = c.vectors.col(i_), slope = (corners[bits | bit]->vectors.col(i_) -
                                                     corners[bits & ~bit]->vectors.col(i_)) *
                                                    (2 / width);
      const auto first = c.values.col(o), second = c.values.col(o + m);
      const auto block = [this](const auto& column, Index b, Index count) {
        return Eigen::Map<const MatrixXd>(column.data() + b * n_ * n_, n_, count * n_);
      };
      out(0) =
          std::max(out(0), (sources(first).transpose() * slope + sources(second).transpose() * v)
                               .cwiseAbs()
                               .dot(most_));
      out.segment(1, n_) = out.segment(1, n_).cwiseMax(
          (block(first, 0, 1) * slope.head(n_) + block(second, 0, 1) * v.head(n_)).cwiseAbs());
      if (reduced_)
        out.tail(n_) = out.tail(n_).cwiseMax(
            (block(first, 1, 2) * slope + block(second, 1, 2) * v).cwiseAbs());
    }
    return out;
  }

  /// What lies between the corners, by variable.
  void addBetween(const std::vector<CornerAt>& corners, const VectorXd& mean,
                  const VectorXd& concave, double largest, Box* box) const {
    const std::size_t m = box->q.size();
    const Slopes slopes = slopesOf(corners, *box, mean);
    VectorXd adds = VectorXd::Zero(static_cast<Index>(m) + n_);
    double rounded = 0;
    for (std::size_t k = 0; k < m; ++k) {
      const double w = half(box->q[k]);
      if (w == 0) continue;
      const std::size_t o = 1 + k, oo = o + m;
      VectorXd between =
          curvature(corners, *box, k) + 2 * (2 * lost_[o] * slopes.first[k] + lost_[oo] * mean);
      for (std::size_t l = 0; l < m; ++l) {
        const double w2 = 0.5 * std::pow(half(box->q[l]), 2);
        between +=
            w2 * (beyond_[l][oo] * mean + (l == k ? 4 : 2) * (beyond_[l][o] * slopes.first[k]));
        if (l != k)
          between += w2 * (2 * (beyond_[k][1 + l] * slopes.first[l]) +
                           4 * (mixed_[k][l] * slopes.second[k][l]));
      }
      const VectorXd everywhere = 2 * (largest_[o] * slopes.first[k]) + largest_[oo] * mean;
      adds(static_cast<Index>(k)) = 0.5 * w * w * weights_.dot(between.cwiseMin(everywhere));
      // differences of l and k are known to roundings of these
      rounded += 4 * kLost * w * weights_.dot(largest_[o] * mean);
    }
    for (Index a = 0; a < n_; ++a)
      adds(static_cast<Index>(m) + a) =
          std::pow(half(box->qd[static_cast<std::size_t>(a)]), 2) * concave(a);
    box->bound = (largest + adds.sum() + rounded) * (1 + kLost);
    if (!(box->bound >= 0)) return haveNoBound(box);  // inf times 0 is none
    Index most = 0;
    box->split = adds.maxCoeff(&most) > 0 ? static_cast<int>(most) : -1;
  }

  const TrigonometricModel* reduced_;  ///< none: (3)
  Index size_;                         ///< of (l, k), or of k
  std::vector<double> accelerations_;
  std::vector<std::pair<int, int>> sources_;  ///< qd_a qd_b; -1: gravity, loads and springs
  VectorXd most_;                             ///< that each is multiplied by
  PolynomialTable table_;
  /// Operators, by column of the table: what may be off, the largest, and sup |d^2/dq_l^2|.
  std::vector<MatrixXd> lost_, largest_;
  std::vector<std::vector<MatrixXd>> beyond_;
  std::vector<std::vector<MatrixXd>> mixed_;  ///< d^2/dq_k dq_l
  CornersKnown<CornerAt> corners_{kMostCorners};
  VectorXd weights_;  ///< 1, |e_j|, |qdd_j|
};

AccelerationErrors::AccelerationErrors(const TrigonometricModel& full,
                                       const TrigonometricModel& reduced,
                                       const std::vector<JointRanges>& ranges,
                                       const std::vector<double>& accelerations)
    : search_(std::make_unique<Search>(full, &reduced, ranges, accelerations)) {}
AccelerationErrors::AccelerationErrors(const TrigonometricModel& model,
                                       const std::vector<JointRanges>& ranges)
    : search_(std::make_unique<Search>(model, nullptr, ranges, std::vector<double>())) {}
AccelerationErrors::~AccelerationErrors() = default;

EnvelopeBound AccelerationErrors::of(int i, const std::vector<double>& within,
                                     const EnvelopeOptions& options, double decide) {
  return search_->over(Search::nothingKnown(i), within, options, decide);
}

EnvelopeBound AccelerationErrors::better(const EnvelopeBound& before,
                                         const std::vector<double>& within,
                                         const EnvelopeOptions& options, double decide) {
  return search_->over(before, within, options, decide);
}

}  // namespace dynwitness::crosscheck
