// SPDX-License-Identifier: GPL-3.0-or-later
// A tree without joint forces as equations of motion, in double and long double.
#pragma once

#include "crosscheck/motion/motion_equations.hpp"
#include "crosscheck/scalars/dual.hpp"
#include "recursive/energy.hpp"
#include "recursive/model.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** y = (q, qd, what friction has taken [J]), by articulated bodies. dL/dq + Q follows from Newton
    and Euler, at qdd = 0:

        dL/dq + Q = dM/dt qd - tau(q, qd, 0),   dM/dt qd = d/de M(q + e qd) qd   by duals */
template <typename T>
class TreeMotion : public MotionEquations<T> {
 public:
  using State = typename MotionEquations<T>::State;

  /// @param moved_by  whose qdd it moves with, nullptr: its own
  explicit TreeMotion(const scene::Mechanism& mechanism,
                      const scene::Mechanism* moved_by = nullptr);

  int positions() const override { return model_.positions; }
  int dof() const override { return model_.dof(); }
  void rate(const State& y, T time, State* rate) override;
  T power(const State& y, T time) override;
  void move(State* y, const State& u) const override;
  State commutator(const State& u, const State& v) const override;
  bool hasMomenta() const override { return has_momenta_; }
  State momentum(const State& y) override;
  State velocity(const State& y, const State& p) override;
  State pull(const State& y) override;

  T kinetic(const State& y);
  /// T + V, and with friction what it has taken: the sum must not change.
  T energy(const State& y);
  /// Of all links, about the world's origin: forces first [N s, N m s].
  State totalMomentum(const State& y);
  /// M qdd + c + g - Q at a motion's own accelerations [n]: what its forces would have had to be.
  State residual(const State& y, const State& qdd);

 private:
  using Moving = Dual<T>;
  void split(const State& y);

  recursive::Model<T> model_, moving_;
  recursive::Workspace<T> ws_;
  recursive::Model<Moving> lifted_;
  recursive::Workspace<Moving> ws_lifted_;
  std::vector<scene::JointPosition<T>> x_;
  State qd_, qdd_, q_rate_, zeros_;
  bool has_momenta_;
};

/// The scene's start and nothing taken yet.
template <typename T>
std::vector<T> startOf(const scene::Scene& scene);

extern template class TreeMotion<double>;
extern template class TreeMotion<long double>;

}  // namespace dynwitness::crosscheck
