// SPDX-License-Identifier: GPL-3.0-or-later
// What searches for the largest acceleration, or error of one, have in common.
#pragma once

#include <functional>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/reduction/boxes.hpp"
#include "crosscheck/reduction/envelope.hpp"

namespace dynwitness::crosscheck {

/** A search over boxes in q and qd for the largest |x| of

        x = row'(tau - friction) + constant + sum_{b<=a} form(a, b) qd_a qd_b

    row, constant and form depending on q, tau and qd being anywhere in their ranges. Of friction
    the viscous part is linear in qd; the dry one jumps where qd changes its sign. */
class AccelerationBoxes {
 protected:
  /// @param ranges  each with tau; they and the model must outlive this
  AccelerationBoxes(const TrigonometricModel& model, const std::vector<scene::JointRanges>& ranges)
      : model_(model), n_(model.dof), ranges_(&ranges) {}

  /// @param active  joints of Box::q
  /// @param decide  as boundOfParts()
  /// @param before  what is known already of the same: only what is better is looked for
  /// @param judge   as of bestFirst()
  /// @param seen_at |x| at a q, the largest over corners in qd of a box, which is remembered
  EnvelopeBound search(
      const EnvelopeBound& before, const std::vector<int>& active, const EnvelopeOptions& options,
      double decide, const std::function<void(Box*)>& judge,
      const std::function<double(const std::vector<double>&, const Box&)>& seen_at);
  /// Of joint i; infinite.
  static EnvelopeBound nothingKnown(int i);

  struct Largest {
    double value, dry;  ///< without dry friction, and what that adds; no roundings in them
    std::vector<double> qd;
  };
  /// Of sign x at a corner in q.
  Largest largest(const Eigen::VectorXd& row, double constant, const Eigen::MatrixXd& form,
                  const Box& box, int sign) const;
  /// Keeps a state where |x| is larger than at all before.
  /// @param value  without dry friction: that is put in by the sign of qd here
  /// @return with it
  double remember(const Eigen::VectorXd& row, const std::vector<double>& q,
                  const std::vector<double>& qd, int sign, double value);

  const scene::JointRanges& at(Eigen::Index k) const {
    return (*ranges_)[static_cast<std::size_t>(k)];
  }
  static const RunningError& of(const std::vector<RunningError>& v, Eigen::Index k) {
    return v[static_cast<std::size_t>(k)];
  }

  const TrigonometricModel& model_;
  Eigen::Index n_, i_ = 0;
  const std::vector<scene::JointRanges>* ranges_;
  double lost_most_ = 0;  ///< by roundings, at the worst of what was judged

 private:
  std::vector<int> active_;
  double seen_ = 0;
  EnvelopeState worst_;
  Climb climb_;
};

/// What products of rates are multiplied by in c, by joint; none: nothing.
using RateProducts = std::map<std::pair<int, int>, std::vector<Polynomial>>;
RateProducts rateProducts(const TrigonometricModel& model);

}  // namespace dynwitness::crosscheck
