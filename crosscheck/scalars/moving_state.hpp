// SPDX-License-Identifier: GPL-3.0-or-later
// A state in motion, as dual numbers: what a sweep is differentiated along.
#pragma once

#include <vector>

#include "crosscheck/scalars/dual.hpp"
#include "recursive/energy.hpp"

namespace dynwitness::crosscheck {

/// How fast each part of a state changes, one number a rate: positions along unit rates
/// (recursive::positionRates()), so along body axes where rates are no derivatives of coordinates.
/// Empty: not at all.
template <typename T>
struct Direction {
  std::vector<T> q, qd, qdd, tau;
};

template <typename T>
std::vector<scene::JointPosition<Dual<T>>> moving(const recursive::Model<T>& model,
                                                  const std::vector<scene::JointPosition<T>>& x,
                                                  const std::vector<T>& rates) {
  std::vector<T> slots(x.size(), T(0));
  if (!rates.empty()) recursive::positionRates(model, x, rates, slots);
  std::vector<scene::JointPosition<Dual<T>>> out;
  for (std::size_t i = 0; i < x.size(); ++i) out.push_back(moving(x[i], slots[i]));
  return out;
}

template <typename T>
scene::State<Dual<T>> moving(const recursive::Model<T>& model, const scene::State<T>& state,
                             const Direction<T>& along) {
  const auto both = [](const std::vector<T>& values, const std::vector<T>& rates) {
    std::vector<Dual<T>> out;
    for (std::size_t i = 0; i < values.size(); ++i)
      out.push_back({values[i], rates.empty() ? T(0) : rates[i]});
    return out;
  };
  return {moving(model, state.x, along.q), both(state.qd, along.qd), both(state.qdd, along.qdd),
          both(state.tau, along.tau)};
}

}  // namespace dynwitness::crosscheck
