// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/envelope.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include <fmt/format.h>
#include <Eigen/Core>

#include "crosscheck/reduction/boxes.hpp"
#include "crosscheck/reduction/corners.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::JointRanges;
using scene::Range;
using Kind = EnvelopeQuantity::Kind;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMostCorners = 100000;  ///< remembered at a time: 250 MB for seven joints

using Part = EnvelopePart;

/// What is known at one corner in q.
struct Corner {
  VectorXd values;     ///< of the parts
  VectorXd curvature;  ///< sup |d^2/dq_k^2| over qd and qdd, by active joint
};

/// What a quantity has beside its parts.
struct Beside {
  bool spring_force = false;   ///< of its joint: k (q - rest)
  bool spring_energy = false;  ///< of all joints: k (q - rest)^2 / 2
  bool friction = false;       ///< of its joint
};

class Search : public BoundedQuantity {
 public:
  Search(const TrigonometricModel& model, const std::vector<JointRanges>& ranges,
         const EnvelopeQuantity& quantity)
      : Search(model, ranges, quantity, envelopeParts(model, quantity),
               {quantity.kind == Kind::kTau || quantity.kind == Kind::kG,
                quantity.kind == Kind::kV || quantity.kind == Kind::kEnergy,
                quantity.kind == Kind::kTau}) {}
  Search(const TrigonometricModel& model, const std::vector<JointRanges>& ranges,
         const EnvelopeQuantity& quantity, std::vector<Part> parts, Beside beside)
      : model_(model),
        ranges_(&ranges),
        quantity_(quantity),
        parts_(std::move(parts)),
        beside_(beside) {
    sizes_.resize(static_cast<Eigen::Index>(parts_.size()));
    for (std::size_t p = 0; p < parts_.size(); ++p)
      sizes_(static_cast<Eigen::Index>(p)) = weight(parts_[p]);
    tabulate();
    bound();
    chooseActive();
    boundDerivatives();
  }

  EnvelopeBound over(const std::vector<JointRanges>& box, const EnvelopeOptions& options,
                     double decide) override {
    ranges_ = &box;
    seen_ = 0;
    worst_ = {};
    climb_.start();
    EnvelopeBound out;
    out.quantity = quantity_;
    Box whole;
    for (const int k : active_) whole.q.push_back(at(k).q);
    for (const int r : rates_) whole.qd.push_back(at(r).qd);
    const BoxesSeen seen = bestFirst(
        whole, options.boxes, [&](Box* box) { judge(box); },
        [&](double bound) { return isKnown(bound, seen_ - 2 * slack_, options, decide); },
        [&] {
          climb_.from(whole.q,
                      [&](const std::vector<double>& q) { return seenAt(computed(q), q, whole); });
        });
    out.certified = seen.bound;
    out.boxes = seen.count;
    out.sampled = std::max(0.0, seen_ - 2 * slack_);
    out.worst = worst_;
    out.lost = slack_;
    return out;
  }

 private:
  const JointRanges& at(int k) const { return (*ranges_)[static_cast<std::size_t>(k)]; }
  bool slides(int k) const { return model_.slides[static_cast<std::size_t>(k)]; }
  const RunningError& of(const std::vector<RunningError>& v) const {
    return v[static_cast<std::size_t>(quantity_.i)];
  }

  /// The largest a part is multiplied by.
  double weight(const Part& part) const {
    if (part.j < 0) return 1;
    if (part.k < 0) return at(part.j).qdd.most();
    return at(part.j).qd.most() * at(part.k).qd.most();
  }

  static int harmonic(int digit) { return (digit + 1) / 2; }
  /// The same of a monomial, differentiated twice by k and twice by l; -1: by none.
  double most(const std::vector<int>& digits, int k, int l) const {
    double product = 1;
    for (int i = 0; i < model_.dof; ++i)
      product *= mostOfFactor(digits[static_cast<std::size_t>(i)], slides(i), at(i).q.most(),
                              2 * (i == k) + 2 * (i == l));
    return product;
  }

  /// Coefficients as a matrix; those that are within their bounds of zero go into the slack.
  void tabulate() {
    std::set<Monomial> monomials;
    const auto counts = [](const RunningError& c) { return std::abs(c.value()) > c.bound(); };
    for (const Part& part : parts_)
      for (const auto& [m, c] : part.f)
        if (counts(c)) monomials.insert(m);
    if (monomials.size() * parts_.size() > kMostMonomials * 64 ||
        monomials.size() > kMostMonomials / 2)
      throw scene::InputError(
          {}, fmt::format("envelope: {} has {} monomials, allowed: up to {}", quantity_.name(),
                          monomials.size(), kMostMonomials / 2));
    std::unordered_map<Monomial, Eigen::Index> column;
    for (const Monomial m : monomials) {
      column.emplace(m, static_cast<Eigen::Index>(digits_.size()));
      std::vector<int> digits;
      for (int k = 0; k < model_.dof; ++k) digits.push_back(digit(m, k));
      digits_.push_back(digits);
    }
    coefficients_.setZero(static_cast<Eigen::Index>(parts_.size()),
                          static_cast<Eigen::Index>(digits_.size()));
    for (std::size_t p = 0; p < parts_.size(); ++p)
      for (const auto& [m, c] : parts_[p].f) {
        std::vector<int> digits;
        for (int k = 0; k < model_.dof; ++k) digits.push_back(digit(m, k));
        const double size = sizes_(static_cast<Eigen::Index>(p)) * most(digits, -1, -1);
        if (counts(c)) {
          coefficients_(static_cast<Eigen::Index>(p), column.at(m)) = c.value();
          slack_ += size * (c.bound() + kLost * std::abs(c.value()));
        } else {
          slack_ += size * (c.bound() + std::abs(c.value()));
        }
      }
  }

  /// What springs and friction of the joint add to the slack.
  void bound() {
    const JointRanges& r = at(quantity_.i);
    const auto lost = [](const RunningError& x, double by) {
      return (x.bound() + kLost * std::abs(x.value())) * by;
    };
    if (beside_.spring_force) {
      const RunningError rest = of(model_.stiffness) * of(model_.rest);
      slack_ += lost(of(model_.stiffness), r.q.most()) + lost(rest, 1);
    }
    for (int k = 0; k < model_.dof; ++k)
      if (hasEnergyOf(k)) {
        const RunningError& by = model_.rest[static_cast<std::size_t>(k)];
        const double stretch = at(k).q.most() + std::abs(by.value()) + by.bound();
        slack_ += lost(model_.stiffness[static_cast<std::size_t>(k)], stretch * stretch) +
                  std::abs(stiffness(k)) * stretch * by.bound();
      }
    if (beside_.friction)
      slack_ += lost(of(model_.viscous), r.qd.most()) + lost(of(model_.positive), 1) +
                lost(of(model_.negative), 1);
  }

  bool hasEnergyOf(int k) const {
    return beside_.spring_energy && model_.stiffness[static_cast<std::size_t>(k)].value() != 0;
  }
  double rest(int k) const { return model_.rest[static_cast<std::size_t>(k)].value(); }
  double stiffness(int k) const { return model_.stiffness[static_cast<std::size_t>(k)].value(); }

  void chooseActive() {
    const auto isActive = [&](int k) {
      if (hasEnergyOf(k)) return true;
      if (beside_.spring_force && k == quantity_.i && of(model_.stiffness).value() != 0)
        return true;
      return std::any_of(digits_.begin(), digits_.end(), [k](const std::vector<int>& d) {
        return d[static_cast<std::size_t>(k)] != 0;
      });
    };
    const auto isRate = [&](int r) {
      if (beside_.friction && r == quantity_.i &&
          (of(model_.viscous).value() != 0 || of(model_.positive).value() != 0 ||
           of(model_.negative).value() != 0))
        return true;
      return std::any_of(parts_.begin(), parts_.end(),
                         [r](const Part& p) { return p.k >= 0 && (p.j == r || p.k == r); });
    };
    for (int k = 0; k < model_.dof; ++k) {
      if (isActive(k)) active_.push_back(k);
      if (isRate(k)) rates_.push_back(k);
    }
    pairs_.setConstant(static_cast<Eigen::Index>(rates_.size()),
                       static_cast<Eigen::Index>(rates_.size()), -1);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      if (parts_[p].k < 0) continue;
      const auto place = [&](int r) {
        return std::find(rates_.begin(), rates_.end(), r) - rates_.begin();
      };
      const auto a = place(parts_[p].j), b = place(parts_[p].k);
      pairs_(a, b) = pairs_(b, a) = static_cast<int>(p);
    }
  }

  /** Bounds everywhere of second and fourth derivatives, and of the second ones of the squares'
      coefficients. Monomials of the same harmonics are one group: they are the products of cos
      or sin of each joint, whose squares add up to 1, so that a group is at most the root of
      the sum of its coefficients' squares (Cauchy and Schwarz), and differentiating twice
      multiplies all of it by the same number. */
  void boundDerivatives() {
    const auto m = static_cast<Eigen::Index>(active_.size());
    const auto r = static_cast<Eigen::Index>(rates_.size());
    second_.setZero(m);
    fourth_.setZero(m, m);
    of_squares_.setZero(r, m);
    second_lost_.setZero(m);
    squares_lost_.setZero(r);
    std::map<std::vector<int>, VectorXd> groups;  // by harmonics: sums of squares, by part
    for (std::size_t t = 0; t < digits_.size(); ++t) {
      std::vector<int> group = digits_[t];
      for (int k = 0; k < model_.dof; ++k)
        if (!slides(k))
          group[static_cast<std::size_t>(k)] = harmonic(group[static_cast<std::size_t>(k)]) * 2;
      const VectorXd column = coefficients_.col(static_cast<Eigen::Index>(t)).cwiseAbs();
      VectorXd& sum = groups.try_emplace(group, VectorXd::Zero(column.size())).first->second;
      sum += column.cwiseAbs2();
      for (Eigen::Index k = 0; k < m; ++k)
        second_lost_(k) +=
            kLost * sizes_.dot(column) * most(digits_[t], active_[static_cast<std::size_t>(k)], -1);
      for (Eigen::Index a = 0; a < r; ++a)
        if (pairs_(a, a) >= 0)
          squares_lost_(a) += kLost * column(pairs_(a, a)) * most(digits_[t], -1, -1);
    }
    for (const auto& [digits, squares] : groups) {
      const VectorXd roots = squares.cwiseSqrt() * (1 + kLost);
      const double weighted = sizes_.dot(roots);
      for (Eigen::Index k = 0; k < m; ++k) {
        const int by = active_[static_cast<std::size_t>(k)];
        second_(k) += weighted * most(digits, by, -1);
        for (Eigen::Index l = 0; l < m; ++l)
          fourth_(k, l) += weighted * most(digits, by, active_[static_cast<std::size_t>(l)]);
        for (Eigen::Index a = 0; a < r; ++a)
          if (pairs_(a, a) >= 0) of_squares_(a, k) += roots(pairs_(a, a)) * most(digits, by, -1);
      }
    }
  }

  /// Values and curvatures at a corner.
  const Corner& corner(const std::vector<double>& q) {
    return corners_.at(q, [this](const std::vector<double>& at) { return computed(at); });
  }

  Corner computed(const std::vector<double>& q) const {
    const std::size_t m = active_.size();
    std::vector<std::array<double, kBasis>> f(m), f2(m);
    for (std::size_t k = 0; k < m; ++k) {
      const double x = q[k];
      if (slides(active_[k])) {
        f[k] = {1, x, x * x, 0, 0};
        f2[k] = {0, 0, 2, 0, 0};
      } else {
        f[k] = {1, std::cos(x), std::sin(x), std::cos(2 * x), std::sin(2 * x)};
        f2[k] = {0, -f[k][1], -f[k][2], -4 * f[k][3], -4 * f[k][4]};
      }
    }
    MatrixXd products(digits_.size(), m + 1);
    for (std::size_t t = 0; t < digits_.size(); ++t) {
      const auto row = static_cast<Eigen::Index>(t);
      for (std::size_t c = 0; c <= m; ++c) {
        double product = 1;
        for (std::size_t k = 0; k < m; ++k) {
          const auto d = static_cast<std::size_t>(digits_[t][static_cast<std::size_t>(active_[k])]);
          product *= c == k + 1 ? f2[k][d] : f[k][d];
        }
        products(row, static_cast<Eigen::Index>(c)) = product;
      }
    }
    const MatrixXd all = coefficients_ * products;
    Corner out{all.col(0), VectorXd::Zero(static_cast<Eigen::Index>(m))};
    for (std::size_t p = 0; p < parts_.size(); ++p)
      for (std::size_t k = 0; k < m; ++k)
        out.curvature(static_cast<Eigen::Index>(k)) +=
            sizes_(static_cast<Eigen::Index>(p)) *
            std::abs(all(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(k + 1)));
    return out;
  }

  /// The largest of sign (c + friction) over the corners of a box in qd.
  double mostOfRates(const Corner& at_q, const Box& box, int sign,
                     std::vector<double>* worst) const {
    const auto r = static_cast<Eigen::Index>(rates_.size());
    MatrixXd form = MatrixXd::Zero(r, r);
    VectorXd linear = VectorXd::Zero(r);
    for (Eigen::Index a = 0; a < r; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b)
        if (pairs_(a, b) >= 0) form(a, b) = at_q.values(pairs_(a, b));
      if (beside_.friction && rates_[static_cast<std::size_t>(a)] == quantity_.i)
        linear(a) = of(model_.viscous).value();
    }
    return largestAtRates(form, linear, box.qd, sign, worst);
  }

  /// The most that dry friction adds, over the rates of a box.
  double mostOfDryFriction(const Box& box, int sign) const {
    const auto a = std::find(rates_.begin(), rates_.end(), quantity_.i) - rates_.begin();
    if (!beside_.friction || a == static_cast<std::ptrdiff_t>(rates_.size())) return 0;
    return largestDryFriction(box.qd[static_cast<std::size_t>(a)], of(model_.positive).value(),
                              of(model_.negative).value(), sign);
  }

  /// The bound of a box, and where it comes from; the largest that is seen at its corners.
  void judge(Box* box) {
    const std::size_t m = active_.size();
    VectorXd curvature = VectorXd::Zero(static_cast<Eigen::Index>(m));
    MatrixXd concave = MatrixXd::Constant(static_cast<Eigen::Index>(rates_.size()), 2, -HUGE_VAL);
    double largest[] = {-HUGE_VAL, -HUGE_VAL};  // of f, of -f
    std::vector<double> qd;
    forCorners(*box, [&](std::size_t, const std::vector<double>& q) {
      const Corner& at_q = corner(q);
      curvature = curvature.cwiseMax(at_q.curvature);
      for (std::size_t a = 0; a < rates_.size(); ++a) {
        const auto row = static_cast<Eigen::Index>(a);
        if (pairs_(row, row) >= 0)
          for (const int sign : {1, -1})  // where sign f is concave in qd_a
            concave(row, sign < 0) =
                std::max(concave(row, sign < 0), -sign * at_q.values(pairs_(row, row)));
      }
      for (const int sign : {1, -1}) {
        const double value = still(at_q, q, sign) + mostOfRates(at_q, *box, sign, &qd);
        double& most = largest[sign < 0];
        most = std::max(most, value + mostOfDryFriction(*box, sign));
        remember(at_q, q, qd, sign, value);
      }
      return true;
    });
    box->bound = 0;
    box->split = -1;
    for (const int negative : {0, 1})
      addInterpolation(curvature, concave.col(negative), largest[negative], negative == 1, box);
  }

  /// The largest |x| that is seen at corners in qd of a box.
  double seenAt(const Corner& at_q, const std::vector<double>& q, const Box& box) {
    double most = 0;
    std::vector<double> qd;
    for (const int sign : {1, -1}) {
      const double value = still(at_q, q, sign) + mostOfRates(at_q, box, sign, &qd);
      most = std::max(most, remember(at_q, q, qd, sign, value));
    }
    return most;
  }

  /// The largest of sign (f + spring + sum a_j qdd_j).
  double still(const Corner& at_q, const std::vector<double>& q, int sign) const {
    double value = sign * at_q.values(0);
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (parts_[p].j >= 0 && parts_[p].k < 0) {
        const double a = sign * at_q.values(static_cast<Eigen::Index>(p));
        value += std::max(a * at(parts_[p].j).qdd.low, a * at(parts_[p].j).qdd.high);
      }
    for (std::size_t k = 0; beside_.spring_force && k < active_.size(); ++k)
      if (active_[k] == quantity_.i)
        value += sign * of(model_.stiffness).value() * (q[k] - of(model_.rest).value());
    for (std::size_t k = 0; k < active_.size(); ++k)
      if (const int a = active_[k]; hasEnergyOf(a))
        value += sign * stiffness(a) * std::pow(q[k] - rest(a), 2) / 2;
    return value;
  }

  /// @param value  without dry friction: that is put in by its sign here
  /// @return with it
  double remember(const Corner& at_q, const std::vector<double>& q, const std::vector<double>& qd,
                  int sign, double value) {
    for (std::size_t a = 0; beside_.friction && a < rates_.size(); ++a)
      if (rates_[a] == quantity_.i && qd[a] != 0)
        value += sign * (qd[a] > 0 ? of(model_.positive).value() : -of(model_.negative).value());
    climb_.saw(value, q);
    if (!(value > seen_)) return value;
    seen_ = value;
    worst_ = {};
    for (int k = 0; k < model_.dof; ++k) {
      worst_.q.push_back(at(k).q.low);
      worst_.qd.push_back(at(k).qd.low);
      worst_.qdd.push_back(at(k).qdd.low);
    }
    for (std::size_t k = 0; k < q.size(); ++k)
      worst_.q[static_cast<std::size_t>(active_[k])] = q[k];
    for (std::size_t a = 0; a < qd.size(); ++a)
      worst_.qd[static_cast<std::size_t>(rates_[a])] = qd[a];
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (parts_[p].j >= 0 && parts_[p].k < 0 &&
          sign * at_q.values(static_cast<Eigen::Index>(p)) >= 0)
        worst_.qdd[static_cast<std::size_t>(parts_[p].j)] = at(parts_[p].j).qdd.high;
    return value;
  }

  /// What lies between the corners, by variable, of f or of -f; there springs' energy is concave.
  void addInterpolation(const VectorXd& curvature, const VectorXd& concave, double largest,
                        bool is_negative, Box* box) const {
    const auto m = static_cast<Eigen::Index>(active_.size());
    VectorXd w2(m);  // half the square of half the width
    for (Eigen::Index k = 0; k < m; ++k)
      w2(k) = 0.5 * std::pow(half(box->q[static_cast<std::size_t>(k)]), 2);
    VectorXd adds(m + static_cast<Eigen::Index>(rates_.size()));
    adds.head(m) = w2.cwiseProduct((curvature + second_lost_ + fourth_ * w2).cwiseMin(second_));
    for (Eigen::Index k = 0; is_negative && k < m; ++k)
      if (const int a = active_[static_cast<std::size_t>(k)]; hasEnergyOf(a))
        adds(k) += w2(k) * stiffness(a);
    const VectorXd squares = (concave + squares_lost_ + of_squares_ * w2).cwiseMax(0);
    for (std::size_t a = 0; a < rates_.size(); ++a)
      adds(m + static_cast<Eigen::Index>(a)) =
          std::pow(half(box->qd[a]), 2) * squares(static_cast<Eigen::Index>(a));
    const double between = adds.sum();
    const double bound = largest + between + kLost * (std::abs(largest) + between) + slack_;
    if (bound < box->bound) return;
    box->bound = bound;
    Eigen::Index most = 0;
    box->split = adds.size() > 0 && adds.maxCoeff(&most) > 0 ? static_cast<int>(most) : -1;
  }

  const TrigonometricModel& model_;
  const std::vector<JointRanges>* ranges_;  ///< all of them, then those of one box within
  EnvelopeQuantity quantity_;
  std::vector<Part> parts_;
  VectorXd sizes_;  ///< the most that each part is multiplied by
  Beside beside_;
  std::vector<std::vector<int>> digits_;  ///< of the monomials
  MatrixXd coefficients_;                 ///< parts x monomials
  double slack_ = 0;                      ///< coefficients not known, and roundings
  std::vector<int> active_, rates_;       ///< joints whose q, and whose qd, it depends on
  Eigen::MatrixXi pairs_;                 ///< part of qd_a qd_b; -1: none
  VectorXd second_;                       ///< sup |d^2/dq_k^2| everywhere
  /// The same of d^4/dq_k^2 dq_l^2, and of squares' coefficients (boundDerivatives).
  MatrixXd fourth_, of_squares_;
  VectorXd second_lost_, squares_lost_;  ///< roundings of curvatures
  CornersKnown<Corner> corners_{kMostCorners};
  double seen_ = 0;
  EnvelopeState worst_;
  Climb climb_;
};

}  // namespace

double EnvelopeBound::ratio() const {
  if (sampled > 0) return certified / sampled;
  return certified > 0 ? HUGE_VAL : 1;
}

EnvelopeBound boundOfParts(const TrigonometricModel& model, const std::vector<JointRanges>& ranges,
                           const EnvelopeQuantity& name, const std::vector<EnvelopePart>& parts,
                           const EnvelopeOptions& options, double decide) {
  EnvelopeBound bound = Search(model, ranges, name, parts, {}).over(ranges, options, decide);
  bound.is_reached = bound.certified <= (decide < 0 ? options.ratio * bound.sampled : decide) ||
                     bound.certified <= 2 * bound.lost;
  return bound;
}

std::unique_ptr<BoundedQuantity> boundedQuantity(const TrigonometricModel& model,
                                                 const std::vector<JointRanges>& within,
                                                 const EnvelopeQuantity& quantity,
                                                 const std::vector<EnvelopePart>& parts) {
  if (quantity.kind == Kind::kReaction)
    return std::make_unique<Search>(model, within, quantity, parts, Beside());
  return std::make_unique<Search>(model, within, quantity);
}

}  // namespace dynwitness::crosscheck
