// SPDX-License-Identifier: GPL-3.0-or-later
// The textbook's derivatives (recursive/derivatives.hpp) on any scalar, asked as the fast ones are.
#pragma once

#include "crosscheck/witnesses/fast_derivatives.hpp"
#include "recursive/derivatives.hpp"

namespace dynwitness::crosscheck {

template <typename T>
class TextbookDerivatives {
 public:
  using Matrices = typename FastDerivatives<T>::Matrices;
  explicit TextbookDerivatives(recursive::Model<T> model);

  /// Of tau at q, qd and qdd.
  Matrices ofForces(const scene::State<T>& s);
  /// Of qdd at q and qd, where it is that of the state.
  Matrices ofAccelerations(const scene::State<T>& s);

 private:
  recursive::Model<T> model_;
  recursive::DerivativesWorkspace<T> room_;
  recursive::InverseDynamicsDerivatives<T> of_tau_;
  recursive::ForwardDynamicsDerivatives<T> of_qdd_;
};

// not in the class: what is inline is compiled in every file, extern or not

template <typename T>
TextbookDerivatives<T>::TextbookDerivatives(recursive::Model<T> model)
    : model_(std::move(model)), room_(model_), of_tau_(model_), of_qdd_(model_) {}

template <typename T>
typename TextbookDerivatives<T>::Matrices TextbookDerivatives<T>::ofForces(
    const scene::State<T>& s) {
  recursive::inverseDynamicsDerivatives(model_, s.x, s.qd, s.qdd, room_, of_tau_);
  return {of_tau_.dtau_dq, of_tau_.dtau_dqd, of_tau_.M};
}

template <typename T>
typename TextbookDerivatives<T>::Matrices TextbookDerivatives<T>::ofAccelerations(
    const scene::State<T>& s) {
  recursive::forwardDynamicsDerivatives(model_, s.x, s.qd, s.qdd, room_, of_tau_, of_qdd_);
  return {of_qdd_.dqdd_dq, of_qdd_.dqdd_dqd, of_qdd_.dqdd_dtau};
}

// compiled once (textbook_derivatives*.cpp)
extern template class TextbookDerivatives<double>;
extern template class TextbookDerivatives<RunningError>;
extern template class TextbookDerivatives<AdjointError>;

}  // namespace dynwitness::crosscheck
