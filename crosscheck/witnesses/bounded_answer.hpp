// SPDX-License-Identifier: GPL-3.0-or-later
// From a computation in double and the same one with running error bounds to an answer.
#pragma once

#include <vector>

#include "crosscheck/scalars/exact_state.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/matrix.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {

using scene::MatrixX;

template <typename T>
MatrixX<T> column(const std::vector<T>& v) {
  return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(v.data(), v.size());
}

template <typename T>
MatrixX<T> scalar(const T& x) {
  return MatrixX<T>::Constant(1, 1, x);
}

/// runningErrorState() of a mechanism where joints may follow others: their positions are rounded
/// where they are formed.
inline scene::State<RunningError> runningErrorState(const scene::State<double>& state,
                                                    const scene::Mechanism& mechanism) {
  scene::State<RunningError> out = runningErrorState(state);
  if (!mechanism.hasMimics()) return out;
  const RunningErrorNumbers number(mechanism);
  for (const scene::Follower& f : scene::followers(mechanism))
    out.x[f.slot] = runningErrorPosition(
        number(scene::Number(f.multiplier)) * out.x[f.leader_slot].q + number(f.offset));
  return out;
}

inline Answer boundedAnswer(const Eigen::MatrixXd& value, const MatrixX<RunningError>& bounded) {
  return {value, bounded.unaryExpr([](const RunningError& x) { return x.bound(); })};
}

}  // namespace dynwitness::crosscheck
