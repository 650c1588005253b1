// SPDX-License-Identifier: GPL-3.0-or-later
// The fast derivatives of recursive/fast/ on any scalar.
#pragma once

#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/witnesses/fast_sweeps.hpp"
#include "recursive/fast/forward_dynamics_derivatives.hpp"
#include "recursive/tree_factorization.hpp"

namespace dynwitness::crosscheck {

/// Of a tree whose joints have rates of their own.
template <typename T>
class FastDerivatives {
 public:
  /// n x n each: of tau by q, qd and qdd, or of qdd by q, qd and tau.
  struct Matrices {
    recursive::RowsX<T> by_q, by_qd, by_last;
  };
  explicit FastDerivatives(const recursive::Model<T>& model)
      : FastDerivatives(recursive::fast::Plan<T>(model)) {}
  explicit FastDerivatives(recursive::fast::Plan<T> of) : plan(std::move(of)), room_(plan) {}

  /// Of tau at q, qd and qdd.
  Matrices ofForces(const scene::State<T>& s);
  /// Of qdd at q and qd, where it is that of the state.
  Matrices ofAccelerations(const scene::State<T>& s);

  const recursive::fast::Plan<T> plan;

 private:
  recursive::fast::AccelerationDerivativesWorkspace<T> room_;
};

// not in the class: what is inline is compiled in every file, extern or not

template <typename T>
typename FastDerivatives<T>::Matrices FastDerivatives<T>::ofForces(const scene::State<T>& s) {
  const std::size_t n = plan.dof;
  const recursive::RowsX<T> empty = recursive::RowsX<T>::Constant(plan.dof, plan.dof, T(0));
  Matrices out{empty, empty, empty};
  recursive::fast::inverseDynamicsDerivatives<T>(
      plan, s.x.data(), s.qd.data(), s.qdd.data(), room_.of_tau,
      {out.by_q.data(), out.by_qd.data(), n, out.by_last.data(), n});
  return out;
}

template <typename T>
typename FastDerivatives<T>::Matrices FastDerivatives<T>::ofAccelerations(
    const scene::State<T>& s) {
  const recursive::RowsX<T> empty = recursive::RowsX<T>::Constant(plan.dof, plan.dof, T(0));
  Matrices out{empty, empty, empty};
  recursive::fast::forwardDynamicsDerivatives<T>(
      plan, s.x.data(), s.qd.data(), s.qdd.data(), room_,
      {out.by_q.data(), out.by_qd.data(), out.by_last.data()});
  return out;
}

// compiled once, and without much optimisation, as FastSweeps is (fast_derivatives_*.cpp)
extern template class FastDerivatives<AdjointError>;
extern template class FastDerivatives<PrimeField>;
extern template class FastDerivatives<RunningError>;
extern template class FastDerivatives<Ball>;

}  // namespace dynwitness::crosscheck
