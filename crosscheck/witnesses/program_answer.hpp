// SPDX-License-Identifier: GPL-3.0-or-later
// The answer of what computes M and tau in its own way, and qdd from M = L D L'.
#pragma once

#include "crosscheck/witnesses/sharp_bounds.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"

namespace dynwitness::crosscheck {

/** Completes an answer by its bounds.
    @param with_bounds, sharp  what answers (quantity, state) on RunningError, and on AdjointError
    @param solve_bound  of M = L D L' */
template <typename WithBounds, typename Sharp>
Answer answerOfProgram(Quantity quantity, const scene::State<double>& state,
                       const scene::Mechanism& mechanism, WithBounds& with_bounds, Sharp& sharp,
                       SolveBound& solve_bound, Answer out) {
  const auto bound = [&](Quantity asked, const scene::State<double>& at) {
    const scene::State<RunningError> bounded_state = runningErrorState(at, mechanism);
    return sharp(with_bounds(asked, bounded_state), [&](auto& computation) {
      return computation(asked, adjointState(bounded_state));
    });
  };
  if (quantity != Quantity::kQdd) {
    out.bound = bound(quantity, state);
    return out;
  }
  out.bound = boundedAnswer({}, with_bounds(quantity, runningErrorState(state, mechanism))).bound;
  // the elimination's part counts M by composite bodies: what this M may be off by comes on top
  const Eigen::MatrixXd bound_of_tau = bound(Quantity::kTau, moving(state, out.value)) +
                                       bound(Quantity::kM, state) * out.value.cwiseAbs();
  const auto answered = [&](auto& computation) {
    return computation(quantity, adjointState(runningErrorState(state, mechanism)));
  };
  solve_bound.judge(state, bound_of_tau, out, sharp, answered, kWideResidualOfProgram);
  return out;
}

}  // namespace dynwitness::crosscheck
