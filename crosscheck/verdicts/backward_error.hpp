// SPDX-License-Identifier: GPL-3.0-or-later
// How qdd is judged: by what it leaves of the equations of motion, exactly.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** The backward error of an answer qdd at a state, every double taken as the number that it is:

        r = M qdd + c + g + friction - tau - Q                      [N m, N], shape n x 1

    by inverse dynamics in balls, where nothing is divided. For two answers x and y the difference
    of their residuals is M (x - y): they are the same qdd exactly when it is 0, as M is regular.

    The limit of r comes with the answer (Answer::residual_bound, solve_bound.hpp derives it). What
    is counted in ulp is  eps max_i (|tau_i| + |c + g + ...|_i + sum_j |M_ij| |qdd_j|),  eps =
    2^-52. */
struct Residual {
  MatrixX<Ball> value;
  double size = 0;  ///< max_i (...), what ulp are counted of [N m, N]
};

class BackwardError {
 public:
  static constexpr long kMaxBits = 4096;

  explicit BackwardError(const PreparedScene& scene);
  ~BackwardError();

  /// The state that is asked about from here on.
  void at(const scene::State<double>& state);

  /** The residual of this qdd, its balls far below an ulp: the precision is doubled until they are,
      or until kMaxBits. An answer that is no number leaves balls that are not finite. */
  Residual operator()(const Eigen::MatrixXd& qdd);

  /** lambda_max / lambda_min of  M_ij / sqrt(M_ii M_jj), in double: that M as it stands depends on
      the units of its joints. Says how many digits of qdd the residual may hide; nothing is judged
      by it. */
  double condition() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dynwitness::crosscheck
