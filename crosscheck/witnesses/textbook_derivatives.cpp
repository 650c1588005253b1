// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/textbook_derivatives.hpp"

namespace dynwitness::crosscheck {

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

template class TextbookDerivatives<double>;
template class TextbookDerivatives<RunningError>;
template class TextbookDerivatives<AdjointError>;

}  // namespace dynwitness::crosscheck
