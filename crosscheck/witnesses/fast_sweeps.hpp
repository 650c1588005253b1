// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps of recursive/fast/ on any scalar, as a witness asks them.
#pragma once

#include <stdexcept>

#include "crosscheck/scalars/adjoint_error.hpp"
#include "crosscheck/scalars/prime_field.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "recursive/fast/forward_dynamics.hpp"
#include "recursive/fast/inverse_dynamics.hpp"
#include "recursive/fast/mass_matrix.hpp"

namespace dynwitness::crosscheck {

/// Zero without doubt: what a plan may leave out.
inline bool isExactlyZero(const RunningError& x) {
  return x.value() == 0 && x.bound() == 0;
}
inline bool isExactlyZero(const AdjointError& x) {
  return isExactlyZero(x.running());
}

inline constexpr const char* kFastName = "fast";

template <typename T>
class FastSweeps {
 public:
  explicit FastSweeps(const recursive::Model<T>& model);

  static bool answers(Quantity quantity) {
    return quantity == Quantity::kM || quantity == Quantity::kTau || quantity == Quantity::kQdd;
  }
  MatrixX<T> operator()(Quantity quantity, const scene::State<T>& s);

  recursive::fast::Plan<T> plan;  ///< tests plant their errors here

 private:
  recursive::fast::InverseDynamicsWorkspace<T> id_;
  recursive::fast::MassMatrixWorkspace<T> m_;
  recursive::fast::ForwardDynamicsWorkspace<T> fd_;
};

// not in the class: what is inline is compiled in every file, extern or not

template <typename T>
FastSweeps<T>::FastSweeps(const recursive::Model<T>& model)
    : plan(model), id_(plan), m_(plan), fd_(plan) {}

template <typename T>
MatrixX<T> FastSweeps<T>::operator()(Quantity quantity, const scene::State<T>& s) {
  namespace fast = recursive::fast;
  const int n = plan.dof;
  MatrixX<T> out = MatrixX<T>::Constant(n, quantity == Quantity::kM ? n : 1, T(0));
  if (quantity == Quantity::kM)
    fast::massMatrix(plan, s.x.data(), m_, out.data());
  else if (quantity == Quantity::kTau)
    fast::inverseDynamics(plan, s.x.data(), s.qd.data(), s.qdd.data(), id_, out.data());
  else if (quantity == Quantity::kQdd)
    fast::forwardDynamics(plan, s.x.data(), s.qd.data(), s.tau.data(), fd_, out.data());
  else
    throw std::logic_error("fast: not answered");
  return out;
}

// compiled once, and without much optimisation: all of a sweep is inlined, which takes a compiler
// minutes for a scalar that is no double (fast_sweeps_bounds.cpp, fast_sweeps_exact.cpp)
extern template class FastSweeps<RunningError>;
extern template class FastSweeps<AdjointError>;
extern template class FastSweeps<PrimeField>;

}  // namespace dynwitness::crosscheck
