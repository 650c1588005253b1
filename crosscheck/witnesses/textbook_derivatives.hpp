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

// in textbook_derivatives.cpp
extern template class TextbookDerivatives<double>;
extern template class TextbookDerivatives<RunningError>;
extern template class TextbookDerivatives<AdjointError>;

}  // namespace dynwitness::crosscheck
