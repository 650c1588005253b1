// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_bound.hpp"

#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {

struct EngineBound::Impl {
  Setup<RunningError> setup;
  ForwardDynamicsBy method;
};

EngineBound::EngineBound(const scene::Mechanism& mechanism, ForwardDynamicsBy method)
    : impl_(new Impl{Setup<RunningError>(recursive::buildModel(
                         mechanism, RunningErrorNumbers(mechanism, QuarterTurns::kRounded),
                         recursive::FixedJoints::kKept, recursive::Axes::kTurned)),
                     method}) {}
EngineBound::~EngineBound() = default;

Eigen::MatrixXd EngineBound::operator()(Quantity quantity, const scene::State<double>& state) {
  const scene::State<RunningError> bounded = runningErrorState(state);
  MatrixX<RunningError> computed;
  if (quantity != Quantity::kQdd)
    computed = NewtonEuler::answer(impl_->setup, quantity, bounded);
  else if (impl_->method == ForwardDynamicsBy::kSweep)
    computed = ArticulatedBody::answer(impl_->setup, quantity, bounded);
  else
    computed = CompositeBody::answer(impl_->setup, quantity, bounded);
  double largest = 0;
  for (Eigen::Index j = 0; j < computed.cols(); ++j)
    for (Eigen::Index i = 0; i < computed.rows(); ++i)
      largest = std::max(largest, computed(i, j).bound());
  return Eigen::MatrixXd::Constant(computed.rows(), computed.cols(), largest);
}

}  // namespace dynwitness::crosscheck
