// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/acceleration_boxes.hpp"

#include <algorithm>
#include <cmath>

namespace dynwitness::crosscheck {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

EnvelopeBound AccelerationBoxes::nothingKnown(int i) {
  EnvelopeBound out;
  out.quantity = {EnvelopeQuantity::Kind::kQdd, i, 0};
  out.certified = HUGE_VAL;
  return out;
}

EnvelopeBound AccelerationBoxes::search(
    const EnvelopeBound& before, const std::vector<int>& active, const EnvelopeOptions& options,
    double decide, const std::function<void(Box*)>& judge,
    const std::function<double(const std::vector<double>&, const Box&)>& seen_at) {
  i_ = before.quantity.i;
  active_ = active;
  seen_ = before.sampled;
  worst_ = before.worst;
  lost_most_ = before.lost;
  climb_.start();
  Box whole;
  for (const int k : active) whole.q.push_back(at(k).q);
  for (Index r = 0; r < n_; ++r) whole.qd.push_back(at(r).qd);
  const BoxesSeen seen = bestFirst(
      whole, options.boxes, judge,
      [&](double bound) {
        return isKnown(std::min(bound, before.certified), seen_, options, decide);
      },
      [&] {
        climb_.from(whole.q, [&](const std::vector<double>& q) { return seen_at(q, whole); });
      });
  EnvelopeBound out = before;
  out.certified = std::min(seen.bound, before.certified);
  out.sampled = seen_;
  out.boxes += seen.count;
  out.worst = worst_;
  out.lost = lost_most_;
  return out;
}

AccelerationBoxes::Largest AccelerationBoxes::largest(const VectorXd& row, double constant,
                                                      const MatrixXd& form, const Box& box,
                                                      int sign) const {
  Largest out{sign * constant, 0, {}};
  VectorXd linear(n_);
  for (Index j = 0; j < n_; ++j) {
    const double r = row(j);
    linear(j) = -r * of(model_.viscous, j).value();
    out.value += std::max(sign * r * at(j).tau->low, sign * r * at(j).tau->high);
    out.dry +=
        largestDryFriction(box.qd[static_cast<std::size_t>(j)], -r * of(model_.positive, j).value(),
                           -r * of(model_.negative, j).value(), sign);
  }
  out.value += largestAtRates(form, linear, box.qd, sign, &out.qd);
  return out;
}

double AccelerationBoxes::remember(const VectorXd& row, const std::vector<double>& q,
                                   const std::vector<double>& qd, int sign, double value) {
  for (Index j = 0; j < n_; ++j) {
    const double rate = qd[static_cast<std::size_t>(j)];
    const double dry = rate > 0   ? of(model_.positive, j).value()
                       : rate < 0 ? -of(model_.negative, j).value()
                                  : 0;
    value -= sign * row(j) * dry;
  }
  climb_.saw(value, q);
  if (!(value > seen_)) return value;
  seen_ = value;
  worst_ = {};
  worst_.qd = qd;
  for (Index j = 0; j < n_; ++j) {
    worst_.q.push_back(at(j).q.low);
    worst_.tau.push_back(sign * row(j) >= 0 ? at(j).tau->high : at(j).tau->low);
  }
  for (std::size_t k = 0; k < q.size(); ++k) worst_.q[static_cast<std::size_t>(active_[k])] = q[k];
  return value;
}

RateProducts rateProducts(const TrigonometricModel& model) {
  RateProducts out;
  for (int j = 0; j < model.dof; ++j)
    for (EnvelopePart& part : envelopeParts(model, {EnvelopeQuantity::Kind::kC, j, 0})) {
      if (part.j < 0) continue;
      std::vector<Polynomial>& column = out[{part.j, part.k}];
      column.resize(model.M.size());
      column[static_cast<std::size_t>(j)] = std::move(part.f);
    }
  return out;
}

}  // namespace dynwitness::crosscheck
