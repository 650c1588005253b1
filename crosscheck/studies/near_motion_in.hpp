// SPDX-License-Identifier: GPL-3.0-or-later
// How T - V and Q near a motion are formed: for the files that compile it, one a scalar.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "crosscheck/studies/dependent_rates.hpp"
#include "crosscheck/studies/near_motion.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {

/// Beside those of flow.hpp.
inline scene::JointPosition<RunningError> slotPosition(const RunningError& q) {
  return runningErrorPosition(q);
}

namespace hamilton {

inline double magnitude(double x) {
  return std::abs(x);
}
inline double magnitude(const RunningError& x) {
  return std::abs(x.value());
}
template <typename T>
double magnitude(const Dual<T>& x) {
  return std::max(magnitude(x.value), magnitude(x.derivative));
}

/// The same number as if it were exact.
template <typename T>
T withoutBound(const T& x) {
  return x;
}
inline RunningError withoutBound(const RunningError& x) {
  return x.value();
}
template <typename T>
Dual<T> withoutBound(const Dual<T>& x) {
  return {withoutBound(x.value), withoutBound(x.derivative)};
}

template <typename S>
Near<S>::Near(const Problem& problem)
    : problem_(problem),
      model_(lifted<S>(problem.model)),
      ws_(model_),
      moving_(lifted<Dual<S>>(problem.model)),
      ws_moving_(moving_),
      closures_(lifted<Dual<S>>(problem.closures, problem.dof())) {}

template <typename S>
void Near<S>::at(const Node& node, const std::vector<S>& zeta, const std::vector<S>& zeta_rate) {
  const int positions = model_.positions;
  if (problem_.coordinates) {
    std::vector<S> slots;
    qd_.clear();
    for (int i = 0; i < positions; ++i) {
      slots.push_back(S(node.slots[i]) + zeta[i]);
      qd_.push_back(S(node.qd[i]) + zeta_rate[i]);
    }
    x_ = slotPositions(slots);
    return;
  }
  using T = Dual<S>;  // along time
  std::vector<T> slots, zeta_moving(problem_.dof(), T(S(0)));
  for (int i = 0; i < positions; ++i) slots.push_back(T(S(node.slots[i]), S(node.slot_rates[i])));
  for (int a = 0; a < problem_.n(); ++a)
    zeta_moving[problem_.surface.rates[a]] = T(zeta[a], zeta_rate[a]);
  if (problem_.isClosed()) follow(node, slots, &zeta_moving);
  const std::vector<T> varied = displaced(slots, zeta_moving);
  std::vector<S> now, rates;
  for (const T& slot : varied) {
    now.push_back(slot.value);
    rates.push_back(slot.derivative);
  }
  x_ = slotPositions(now);
  qd_ = ratesOfSlots(model_, x_, rates);
}

template <typename S>
S Near<S>::lagrangian() {
  S L = recursive::kineticEnergy(model_, x_, qd_, ws_);
  if (problem_.terms.gravity) L -= recursive::potentialEnergy(model_, x_, ws_);
  return L;
}

template <typename S>
S Near<S>::power() {
  S sum = S(0);
  const std::vector<S> Q = forces();
  for (int i = 0; i < problem_.dof(); ++i) sum += Q[i] * qd_[i];
  return sum;
}

template <typename S>
std::vector<S> Near<S>::forces() {
  const std::vector<S> rest(problem_.dof(), S(0));
  std::vector<S> Q(problem_.dof(), S(0));
  recursive::inverseDynamics(model_, x_, rest, rest, ws_, Q, {false, false, problem_.terms.loads});
  for (int i = 0; i < problem_.dof(); ++i) Q[i] = -Q[i] - S(problem_.damping) * qd_[i];
  return Q;
}

template <typename S>
typename Near<S>::Moving Near<S>::displaced(const Moving& slots, const Moving& zeta) {
  Moving change(slots.size(), Dual<S>(S(0)));
  recursive::positionRates(moving_, slotPositions(slots), zeta, change);
  for (std::size_t i = 0; i < slots.size(); ++i) change[i] += slots[i];
  return change;
}

template <typename S>
void Near<S>::follow(const Node& node, const Moving& slots, Moving* zeta) {
  constexpr int kMost = 40;
  const Dependence here(problem_, node.slots);
  const Moving rest(problem_.dof(), Dual<S>(S(0)));
  const Surface& surface = problem_.surface;
  const auto m = static_cast<Eigen::Index>(surface.rows.size());
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMost; ++step) {
    recursive::constraintEquations(moving_, slotPositions(displaced(slots, *zeta)), rest,
                                   ws_moving_, closures_);
    double largest = 0;
    Moving moved;
    for (Eigen::Index i = 0; i < m; ++i) {
      Dual<S> correction(S(0));
      for (Eigen::Index k = 0; k < m; ++k)
        correction += closures_.phi(surface.rows[k]) * Dual<S>(S(here.inverse(i, k)));
      moved.push_back((*zeta)[surface.dependent[i]] - correction);
      largest = std::max(largest, magnitude(correction));
    }
    // below this a step that does not halve the last one is rounding
    const bool is_last =
        step + 1 == kMost || largest == 0 || (largest < 1e-9 && !(largest < before / 2));
    for (Eigen::Index i = 0; i < m; ++i)
      (*zeta)[surface.dependent[i]] = is_last ? moved[i] : withoutBound(moved[i]);
    if (is_last) return;
    before = largest;
  }
}

}  // namespace hamilton
}  // namespace dynwitness::crosscheck
