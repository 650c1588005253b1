// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of a tree or closed mechanism in small equal steps, on doubles or duals: the derivative of
// a motion is the same steps on duals.
#pragma once

#include <utility>
#include <vector>

#include "crosscheck/scalars/lifted.hpp"
#include "crosscheck/studies/closure_forces.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/constraints.hpp"

namespace dynwitness::crosscheck {

/// A position slot with its cosine and sine, for doubles and nested duals.
inline scene::JointPosition<double> slotPosition(double q) {
  return scene::jointPosition(q);
}
template <typename T>
scene::JointPosition<Dual<T>> slotPosition(const Dual<T>& q) {
  return moving(scene::JointPosition<T>(slotPosition(q.value)), q.derivative);
}
template <typename T>
std::vector<scene::JointPosition<T>> slotPositions(const std::vector<T>& slots) {
  std::vector<scene::JointPosition<T>> x;
  for (const T& q : slots) x.push_back(slotPosition(q));
  return x;
}

/** What recursive::positionRates() undoes: rates qd from the rates of change of position slots: of
    a quaternion q = (w, v)  omega = 2 (w v' - w' v - v x v') / q'q,  and of a floating joint's
    position R' p'. A quaternion's change of length has no part in it. The same for any small change
    of slots. */
template <typename T>
std::vector<T> ratesOfSlots(const recursive::Model<T>& model,
                            const std::vector<scene::JointPosition<T>>& x,
                            const std::vector<T>& slot_rates) {
  using recursive::Vector3;
  std::vector<T> qd(model.dof(), T(0));
  for (const auto& link : model.links) {
    if (link.dof < 0) continue;
    int slot = link.slot, dof = link.dof;
    if (recursive::axisCount(link.kind) == 1) {
      qd[dof] = slot_rates[slot];
      continue;
    }
    if (link.kind == recursive::JointKind::kFloating) {
      const Vector3<T> p_rate(slot_rates[slot], slot_rates[slot + 1], slot_rates[slot + 2]);
      const Vector3<T> v = recursive::rotation(&x[slot + 3]).transpose() * p_rate;
      for (int k = 0; k < 3; ++k) qd[dof + k] = v(k);
      slot += 3;
      dof += 3;
    }
    const T &w = x[slot].q, &w_rate = slot_rates[slot];
    const Vector3<T> v(x[slot + 1].q, x[slot + 2].q, x[slot + 3].q);
    const Vector3<T> v_rate(slot_rates[slot + 1], slot_rates[slot + 2], slot_rates[slot + 3]);
    const T scale = T(2) / (w * w + v.dot(v));
    const Vector3<T> omega = (v_rate * w - v * w_rate - v.cross(v_rate)) * scale;
    for (int k = 0; k < 3; ++k) qd[dof + k] = omega(k);
  }
  return qd;
}

/// A state as the integrator has it.
template <typename T>
struct PhasePoint {
  std::vector<T> slots, qd;
};

/** A tree under gravity, springs, loads (as far as `terms` says) and joint dampers, by the
    articulated-body sweep:  M qdd + c + g = Q - damping qd.  With closures

        M qdd + c + g = Q - damping qd + J' lambda,    J qdd + gamma = 0

    of which nothing keeps phi at 0 but the steps. Steps are the classical Runge-Kutta method's, of
    order 4. */
template <typename T>
class Flow {
 public:
  Flow(recursive::Model<T> model, recursive::Terms terms, double damping = 0)
      : Flow(std::move(model), terms, damping, recursive::Constraints<T>(), {}) {}
  /// @param rows  equations of the closures that stand for all
  Flow(recursive::Model<T> model, recursive::Terms terms, double damping,
       recursive::Constraints<T> closures, std::vector<int> rows)
      : model_(std::move(model)),
        ws_(model_),
        closures_(std::move(closures)),
        rows_(std::move(rows)),
        terms_(terms),
        damping_(damping),
        tau_(model_.dof(), T(0)),
        qdd_(tau_),
        slot_rates_(model_.positions, T(0)) {}

  const recursive::Model<T>& model() const { return model_; }

  std::vector<T> accelerations(const PhasePoint<T>& y) {
    for (int i = 0; i < model_.dof(); ++i) tau_[i] = y.qd[i] * T(-damping_);
    if (!rows_.empty()) return closedAccelerations(y);
    recursive::forwardDynamics(model_, slotPositions(y.slots), y.qd, tau_, ws_, qdd_, terms_);
    return qdd_;
  }
  std::vector<T> slotRates(const PhasePoint<T>& y) {
    recursive::positionRates(model_, slotPositions(y.slots), y.qd, slot_rates_);
    return slot_rates_;
  }
  /// The state a time h [s] later.
  PhasePoint<T> step(const PhasePoint<T>& y, double h) {
    const PhasePoint<T> k_1 = rate(y), k_2 = rate(moved(y, k_1, h / 2)),
                        k_3 = rate(moved(y, k_2, h / 2)), k_4 = rate(moved(y, k_3, h));
    const double sixth = h / 6;
    return moved(moved(moved(moved(y, k_1, sixth), k_2, 2 * sixth), k_3, 2 * sixth), k_4, sixth);
  }

 private:
  std::vector<T> closedAccelerations(const PhasePoint<T>& y) {
    using Vector = recursive::VectorX<T>;
    const int n = model_.dof();
    const auto m = static_cast<Eigen::Index>(rows_.size());
    const auto x = slotPositions(y.slots);
    recursive::MatrixX<T> M(n, n), J(m, n);
    recursive::massMatrix(model_, x, ws_, M);
    recursive::factorize(M);
    std::vector<T> bias(n, T(0));
    recursive::inverseDynamics(model_, x, y.qd, std::vector<T>(n, T(0)), ws_, bias, terms_);
    for (int i = 0; i < n; ++i) qdd_[i] = tau_[i] - bias[i];
    recursive::solve(M, qdd_);
    recursive::constraintEquations(model_, x, y.qd, ws_, closures_);
    Vector lambda(m);
    for (Eigen::Index k = 0; k < m; ++k) {
      lambda(k) = -closures_.gamma(rows_[k]);
      for (int i = 0; i < n; ++i) {
        J(k, i) = closures_.J(rows_[k], i);
        lambda(k) -= J(k, i) * qdd_[i];
      }
    }
    const recursive::MatrixX<T> by_force = byClosureForces(M, J);
    recursive::MatrixX<T> N = J * by_force;
    recursive::factorize(N);
    recursive::solve(N, lambda);
    const Vector pushed = by_force * lambda;
    for (int i = 0; i < n; ++i) qdd_[i] += pushed(i);
    return qdd_;
  }
  PhasePoint<T> rate(const PhasePoint<T>& y) { return {slotRates(y), accelerations(y)}; }
  static PhasePoint<T> moved(PhasePoint<T> y, const PhasePoint<T>& rate, double h) {
    for (std::size_t i = 0; i < y.slots.size(); ++i) y.slots[i] += rate.slots[i] * T(h);
    for (std::size_t i = 0; i < y.qd.size(); ++i) y.qd[i] += rate.qd[i] * T(h);
    return y;
  }

  recursive::Model<T> model_;
  recursive::Workspace<T> ws_;
  recursive::Constraints<T> closures_;
  std::vector<int> rows_;
  recursive::Terms terms_;
  double damping_;
  std::vector<T> tau_, qdd_, slot_rates_;
};

}  // namespace dynwitness::crosscheck
