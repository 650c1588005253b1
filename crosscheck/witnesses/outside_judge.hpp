// SPDX-License-Identifier: GPL-3.0-or-later
// What an answer is held to of which nothing is known but its numbers.
#pragma once

#include <limits>
#include <utility>

#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// What a program in double may lose whose algorithm is not known: what a sweep of its kind does in
/// axes of its own, and of T what it does where it finds T from M.
class OutsideBound {
 public:
  explicit OutsideBound(const PreparedScene& scene) : ours_(scene), bound_(scene) {}

  /// Shaped like the quantity.
  Eigen::MatrixXd operator()(Quantity quantity, const scene::State<double>& state) {
    const Eigen::MatrixXd bound = bound_(quantity, state);
    return quantity == Quantity::kKinetic ? bound.cwiseMax(kineticByMassMatrix(state)) : bound;
  }

 private:
  /// Of T = qd' M qd / 2: what the errors of M and of the sum (4 n roundings) make of it.
  Eigen::MatrixXd kineticByMassMatrix(const scene::State<double>& state) {
    const auto n = static_cast<Eigen::Index>(state.qd.size());
    const Eigen::VectorXd rate = Eigen::Map<const Eigen::VectorXd>(state.qd.data(), n).cwiseAbs();
    const double u = std::numeric_limits<double>::epsilon() / 2;
    const Eigen::MatrixXd M = NewtonEuler::answer(ours_, Quantity::kM, state).cwiseAbs();
    return rate.transpose() * (bound_(Quantity::kM, state) + 4 * u * static_cast<double>(n) * M) *
           rate / 2;
  }

  Setup<double> ours_;  ///< for M
  EngineBound bound_;
};

/// Answers of such a program with these bounds; of qdd, which it may have found by the mass matrix,
/// with what it may leave of the equations.
class OutsideJudge {
 public:
  explicit OutsideJudge(const PreparedScene& scene)
      : bound_(scene), solve_bound_(scene, SolvedBy::kMassMatrix, kEngineTurns) {}

  Answer judged(Quantity quantity, const scene::State<double>& state, Eigen::MatrixXd value) {
    Answer out{std::move(value), bound_(quantity, state)};
    if (quantity == Quantity::kQdd)
      solve_bound_.judge(state, bound_(Quantity::kTau, moving(state, out.value)), out);
    return out;
  }

 private:
  OutsideBound bound_;
  SolveBound solve_bound_;
};

}  // namespace dynwitness::crosscheck
