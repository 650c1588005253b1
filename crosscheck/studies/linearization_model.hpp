// SPDX-License-Identifier: GPL-3.0-or-later
// Derivatives of a tree's equations of motion, in any arithmetic.
#pragma once

#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/scalars/moving_state.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "recursive/energy.hpp"

namespace dynwitness::crosscheck {

/// What is moved by eps: a position along its joint, a rate, a joint force.
enum class MovedPart { kPosition, kRate, kForce };

/** Columns by dual numbers: each sweep runs on x + eps e_k and its eps is the derivative, without a
    step. Positions move along unit rates; so where rates are no derivatives of coordinates
    (spherical, floating joints), derivatives by position are along body axes. */
template <typename T>
class LinearizationModel {
 public:
  using Matrix = recursive::MatrixX<T>;
  using Moving = Dual<T>;

  template <typename Numbers>
  LinearizationModel(const scene::Mechanism& mechanism, const Numbers& number);

  int n() const { return model_.dof(); }

  /// d qdd / d(q | qd | tau) of articulated bodies.
  Matrix ofForward(const scene::State<T>& state, MovedPart part);
  /// d tau / d(q | qd) of Newton and Euler at the state's qdd.
  Matrix ofInverse(const scene::State<T>& state, MovedPart part);
  /// The state moved: its k-th position, rate or force is x + eps.
  scene::State<Moving> moved(const scene::State<T>& state, MovedPart part, int k) const;

  std::vector<T> forward(const scene::State<T>& state);
  /// The forces of joints that make qdd what the state says.
  std::vector<T> inverse(const scene::State<T>& state);
  Matrix massMatrix(const scene::State<T>& state);

 private:
  template <typename Sweep>
  Matrix columns(const scene::State<T>& state, MovedPart part, const Sweep& sweep);

  recursive::Model<T> model_;
  recursive::Workspace<T> ws_;
  recursive::Model<Moving> moving_;
  recursive::Workspace<Moving> ws_moving_;
};

// not in the class: what is inline is compiled in every file, extern or not

template <typename T>
template <typename Numbers>
LinearizationModel<T>::LinearizationModel(const scene::Mechanism& mechanism, const Numbers& number)
    : model_(recursive::buildModel(mechanism, number)),
      ws_(model_),
      moving_(lifted<Moving>(model_)),
      ws_moving_(moving_) {}

template <typename T>
recursive::MatrixX<T> LinearizationModel<T>::ofForward(const scene::State<T>& state,
                                                       MovedPart part) {
  return columns(state, part, [&](const scene::State<Moving>& at, std::vector<Moving>& out) {
    recursive::forwardDynamics(moving_, at.x, at.qd, at.tau, ws_moving_, out);
  });
}

template <typename T>
recursive::MatrixX<T> LinearizationModel<T>::ofInverse(const scene::State<T>& state,
                                                       MovedPart part) {
  return columns(state, part, [&](const scene::State<Moving>& at, std::vector<Moving>& out) {
    recursive::inverseDynamics(moving_, at.x, at.qd, at.qdd, ws_moving_, out);
  });
}

template <typename T>
scene::State<Dual<T>> LinearizationModel<T>::moved(const scene::State<T>& state, MovedPart part,
                                                   int k) const {
  Direction<T> along;
  std::vector<T>& rates = part == MovedPart::kPosition ? along.q
                          : part == MovedPart::kRate   ? along.qd
                                                       : along.tau;
  rates.assign(n(), T(0));
  rates[k] = T(1);
  return moving(model_, state, along);
}

template <typename T>
std::vector<T> LinearizationModel<T>::forward(const scene::State<T>& state) {
  std::vector<T> qdd(n(), T(0));
  recursive::forwardDynamics(model_, state.x, state.qd, state.tau, ws_, qdd);
  return qdd;
}

template <typename T>
std::vector<T> LinearizationModel<T>::inverse(const scene::State<T>& state) {
  std::vector<T> tau(n(), T(0));
  recursive::inverseDynamics(model_, state.x, state.qd, state.qdd, ws_, tau);
  return tau;
}

template <typename T>
recursive::MatrixX<T> LinearizationModel<T>::massMatrix(const scene::State<T>& state) {
  Matrix M(n(), n());
  recursive::massMatrix(model_, state.x, ws_, M);
  return M;
}

template <typename T>
template <typename Sweep>
recursive::MatrixX<T> LinearizationModel<T>::columns(const scene::State<T>& state, MovedPart part,
                                                     const Sweep& sweep) {
  Matrix out(n(), n());
  std::vector<Moving> answer(n(), Moving(T(0)));
  for (int k = 0; k < n(); ++k) {
    sweep(moved(state, part, k), answer);
    for (int i = 0; i < n(); ++i) out(i, k) = answer[i].derivative;
  }
  return out;
}

// in linearization_in_balls.cpp
extern template class LinearizationModel<Ball>;
extern template LinearizationModel<Ball>::LinearizationModel(const scene::Mechanism&,
                                                             const BallNumbers&);

}  // namespace dynwitness::crosscheck
