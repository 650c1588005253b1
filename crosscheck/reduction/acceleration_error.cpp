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
using Kind = EnvelopeQuantity::Kind;

constexpr std::size_t kMostCorners = 4000;  ///< remembered at a time: 130 MB for six joints

/// What is known at one corner in q.
struct Corner {
  MatrixXd values;    ///< of the table
  MatrixXd vectors;   ///< (l, k) of every i, by column; none: M or M_r has no inverse
  MatrixXd residual;  ///< |brackets of (2)| there, by column: roundings
};

}  // namespace

class AccelerationErrors::Search : AccelerationBoxes {
 public:
  /// @param reduced  null: (3)
  Search(const TrigonometricModel& full, const TrigonometricModel* reduced,
         const std::vector<JointRanges>& ranges, const std::vector<double>& accelerations)
      : AccelerationBoxes(full, ranges),
        is_of_two_(reduced != nullptr),
        reduced_(reduced ? *reduced : without(full)),
        off_(reduced ? difference(*reduced, full) : without(full)),
        accelerations_(Eigen::Map<const VectorXd>(accelerations.data(),
                                                  static_cast<Index>(accelerations.size()))),
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

  EnvelopeBound over(int i, const std::vector<double>& within, const EnvelopeOptions& options,
                     double decide) {
    weights_.resize(1 + 2 * n_);  // of (3) the second rows are 0
    weights_ << 1, Eigen::Map<const VectorXd>(within.data(), n_), accelerations_;
    return search(i, table_.active(), options, decide, [&](Box* box) { judge(box); });
  }

 private:
  using CornerAt = std::shared_ptr<const Corner>;

  /// Neither M nor g.
  static TrigonometricModel without(TrigonometricModel model) {
    for (std::vector<Polynomial>& row : model.M) row.assign(row.size(), {});
    model.gravity.assign(model.gravity.size(), {});
    return model;
  }

  /// M_r, D and M, column by column; then of each source d and h.
  std::vector<Polynomial> listed() {
    std::vector<Polynomial> all;
    for (const TrigonometricModel* model : {&reduced_, &off_, &model_})
      for (std::size_t b = 0; b < model->M.size(); ++b)
        for (std::size_t a = 0; a < model->M.size(); ++a) all.push_back(model->M[a][b]);
    sources_.assign(1, {-1, -1});
    for (const Polynomial& f : off_.gravity) all.push_back(f);
    for (std::size_t j = 0; j < model_.gravity.size(); ++j) {
      all.push_back(model_.gravity[j]);
      add(model_.loads[j], 1, &all.back());
    }
    std::map<std::pair<int, int>, std::vector<Polynomial>> pairs;
    for (const TrigonometricModel* model : {&off_, &model_})
      for (int j = 0; j < model->dof; ++j)
        for (EnvelopePart& part : envelopeParts(*model, {Kind::kC, j, 0})) {
          if (part.j < 0) continue;
          std::vector<Polynomial>& column = pairs[{part.j, part.k}];
          column.resize(2 * model->M.size());
          column[static_cast<std::size_t>(j) + (model == &off_ ? 0 : model->M.size())] =
              std::move(part.f);
        }
    for (auto& [pair, column] : pairs) {
      sources_.push_back(pair);
      for (Polynomial& f : column) all.push_back(std::move(f));
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
    return {column.data() + 3 * n_ * n_, 2 * n_, most_.size()};
  }
  /// Of magnitudes: what multiplies (l, k) in (2): the forces, each with the most that rates make
  /// of it, and both brackets.
  template <typename Column>
  MatrixXd operatorOf(const Column& column) const {
    MatrixXd out = MatrixXd::Zero(1 + 2 * n_, 2 * n_);
    const VectorXd contiguous = column;
    out.row(0) = (sources(contiguous) * most_).transpose();
    out.block(1, 0, n_, n_) = Eigen::Map<const MatrixXd>(contiguous.data(), n_, n_);
    out.block(1 + n_, 0, n_, 2 * n_) =
        Eigen::Map<const MatrixXd>(contiguous.data() + n_ * n_, n_, 2 * n_);
    return out;
  }

  /// Springs, k (q - rest), are forces of both: in h alone.
  void addSprings() {
    for (std::size_t k = 0; k < table_.active().size(); ++k) {
      const Index j = table_.active()[k];
      const double stiffness = most(of(model_.stiffness, j));
      const double stretch = at(j).q.most() + most(of(model_.rest, j));
      lost_[0](0, n_ + j) += of(model_.stiffness, j).bound() * stretch +
                             stiffness * (of(model_.rest, j).bound() + kLost * stretch);
      lost_[1 + k](0, n_ + j) += of(model_.stiffness, j).bound();
      largest_[0](0, n_ + j) += stiffness * stretch;
      largest_[1 + k](0, n_ + j) += stiffness;
    }
  }

  CornerAt corner(const std::vector<double>& q) {
    return corners_.at(q, [this](const std::vector<double>& at) { return computed(at); });
  }

  CornerAt computed(const std::vector<double>& q) const {
    auto out = std::make_shared<Corner>();
    out->values = table_.at(q);
    for (std::size_t k = 0; k < q.size(); ++k) {
      const Index j = table_.active()[k], row = 3 * n_ * n_ + n_ + j;
      const double stiffness = of(model_.stiffness, j).value();
      out->values(row, 0) += stiffness * (q[k] - of(model_.rest, j).value());
      out->values(row, 1 + static_cast<Index>(k)) += stiffness;
    }
    const auto matrix = [&](Index b) {
      return Eigen::Map<const MatrixXd>(out->values.data() + b * n_ * n_, n_, n_);
    };
    const Eigen::LLT<MatrixXd> full(matrix(2));
    const MatrixXd unit = MatrixXd::Identity(n_, n_);
    MatrixXd l = MatrixXd::Zero(n_, n_), to = -unit;  // D l
    if (is_of_two_) {
      const Eigen::LLT<MatrixXd> reduced(matrix(0));
      if (reduced.info() != Eigen::Success) return out;
      l = reduced.solve(unit);
      to = matrix(1) * l;
    }
    const MatrixXd k = -full.solve(to);
    if (full.info() != Eigen::Success || !l.allFinite() || !k.allFinite()) return out;
    out->vectors.resize(2 * n_, n_);
    out->vectors << l, k;
    out->residual.setZero(1 + 2 * n_, n_);
    if (is_of_two_) out->residual.middleRows(1, n_) = (unit - matrix(0) * l).cwiseAbs();
    out->residual.bottomRows(n_) = (to + matrix(2) * k).cwiseAbs();
    return out;
  }

  void judge(Box* box) {
    const std::size_t m = box->q.size(), count = std::size_t{1} << m;
    std::vector<CornerAt> corners;
    std::vector<double> q(m);
    for (std::size_t bits = 0; bits < count; ++bits) {
      for (std::size_t k = 0; k < m; ++k)
        q[k] = (bits >> k & 1) != 0 ? box->q[k].high : box->q[k].low;
      corners.push_back(corner(q));
      if (corners.back()->vectors.size() == 0) return haveNoBound(box);
    }
    double largest = 0;
    VectorXd concave = VectorXd::Zero(n_), mean = VectorXd::Zero(2 * n_),
             residual = VectorXd::Zero(1 + 2 * n_);
    for (std::size_t bits = 0; bits < count; ++bits) {
      const Corner& c = *corners[bits];
      mean = mean.cwiseMax(c.vectors.col(i_).cwiseAbs());
      residual = residual.cwiseMax(c.residual.col(i_));
    }
    const double lost = lostAt(mean);
    lost_most_ = std::max(lost_most_, lost);
    const double rounded = weights_.dot(residual + 4 * lost_[0] * mean);
    for (std::size_t bits = 0; bits < count; ++bits) {
      for (std::size_t k = 0; k < m; ++k)
        q[k] = (bits >> k & 1) != 0 ? box->q[k].high : box->q[k].low;
      largest = std::max(largest, largestAt(*corners[bits], q, *box, lost + rounded, &concave));
    }
    addBetween(corners, mean, concave, largest + lost + rounded, box);
  }

  /// Of the forces in (2), all over a box.
  double lostAt(const VectorXd& mean) const {
    double out = 2 * lost_[0].row(0).dot(mean);
    for (Index j = 0; j < n_; ++j)
      out += mean(n_ + j) *
             (of(model_.positive, j).bound() + of(model_.negative, j).bound() +
              of(model_.viscous, j).bound() * at(j).qd.most() +
              kLost * (at(j).tau->most() + most(of(model_.viscous, j)) * at(j).qd.most() +
                       most(of(model_.positive, j)) + most(of(model_.negative, j))));
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

  /// The largest |e_i| at a corner in q.
  double largestAt(const Corner& c, const std::vector<double>& q, const Box& box, double lost,
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
    double best = 0;
    for (const int sign : {1, -1}) {
      const Largest of_sign = largest(row, answers(0), form, box, sign);
      const double rounded = kLost * std::abs(of_sign.value);
      remember(row, q, of_sign.qd, sign, of_sign.value - lost - rounded);
      best = std::max(best, of_sign.value + of_sign.dry + rounded);
    }
    return best;
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
    const VectorXd none = VectorXd::Zero(2 * n_);
    Slopes out{mean, {}, std::vector<std::vector<VectorXd>>(m, std::vector<VectorXd>(m, none))};
    const auto v = [&](std::size_t bits) { return corners[bits]->vectors.col(i_); };
    for (std::size_t k = 0; k < m; ++k) {
      const double width = 2 * half(box.q[k]);
      VectorXd first = none;
      for (std::size_t bits = 0; width > 0 && bits < corners.size(); ++bits) {
        if ((bits >> k & 1) != 0) continue;
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
    VectorXd out = VectorXd::Zero(1 + 2 * n_);
    for (std::size_t bits = 0; bits < corners.size(); ++bits) {
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
      out.tail(n_) =
          out.tail(n_).cwiseMax((block(first, 1, 2) * slope + block(second, 1, 2) * v).cwiseAbs());
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

  bool is_of_two_;
  const TrigonometricModel reduced_, off_;
  VectorXd accelerations_;
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
                                       const std::vector<JointRanges>& ranges,
                                       const std::vector<double>& accelerations)
    : search_(std::make_unique<Search>(model, nullptr, ranges, accelerations)) {}
AccelerationErrors::~AccelerationErrors() = default;

EnvelopeBound AccelerationErrors::of(int i, const std::vector<double>& within,
                                     const EnvelopeOptions& options, double decide) {
  return search_->over(i, within, options, decide);
}

}  // namespace dynwitness::crosscheck
