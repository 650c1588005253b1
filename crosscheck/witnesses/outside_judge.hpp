// SPDX-License-Identifier: GPL-3.0-or-later
// What an answer is held to of which nothing is known but its numbers.
#pragma once

#include <limits>
#include <utility>

#include "crosscheck/witnesses/engine_bound.hpp"
#include "crosscheck/witnesses/kinetic_bound.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

/// Bounds of a program in double whose algorithm is not known: of a sweep of its kind in axes of
/// its own, and of a solution by the mass matrix.
class OutsideJudge {
 public:
  explicit OutsideJudge(const PreparedScene& scene)
      : ours_(scene), bound_(scene), solve_bound_(scene, SolvedBy::kMassMatrix, kEngineTurns) {}

  Answer judged(Quantity quantity, const scene::State<double>& state, Eigen::MatrixXd value) {
    Answer out{std::move(value), bound_(quantity, state)};
    if (quantity == Quantity::kQdd)
      solve_bound_.judge(state, bound_(Quantity::kTau, moving(state, out.value)), out);
    if (quantity == Quantity::kKinetic)
      out.bound = out.bound.cwiseMax(kineticBoundByMassMatrix(
          NewtonEuler::answer(ours_, Quantity::kM, state), bound_(Quantity::kM, state),
          Eigen::Map<const Eigen::VectorXd>(state.qd.data(),
                                            static_cast<Eigen::Index>(state.qd.size()))));
    return out;
  }

 private:
  Setup<double> ours_;  ///< for M in the bound of T
  EngineBound bound_;
  SolveBound solve_bound_;
};

}  // namespace dynwitness::crosscheck
