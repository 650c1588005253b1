// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_bound.hpp"

#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

recursive::Model<RunningError> engineModel(const scene::Mechanism& mechanism) {
  return recursive::buildModel(mechanism, RunningErrorNumbers(mechanism, QuarterTurns::kRounded),
                               recursive::FixedJoints::kKept, recursive::Axes::kTurned);
}

}  // namespace

struct EngineBound::Impl {
  Impl(const scene::Mechanism& mechanism, RotorsBy rotors_by)
      : setup(engineModel(mechanism)), without_rotors(engineModel(mechanism)) {
    for (std::size_t i = 0; i < setup.model.links.size(); ++i) {
      const recursive::LinkModel<RunningError>& link = setup.model.links[i];
      if (link.rotor.value() == 0 || rotors_by == RotorsBy::kInertia) continue;
      without_rotors.model.links[i].rotor = 0;
      coupled.push_back(link.dof);
    }
  }

  /// qdd by one multiplier a rotor. With G = (coupled rows of 1) on the joints and the rotors' own
  /// inertia d:  (G M^-1 G' + 1/d) lambda = G a_free,   a = a_free - M^-1 G' lambda.
  MatrixX<RunningError> accelerations(const scene::State<RunningError>& state) {
    const MatrixX<RunningError> a_free = forward(state, state.qd, state.tau, Terms::all());
    const int m = static_cast<int>(coupled.size()), n = setup.model.dof();
    MatrixX<RunningError> M_inverse_G(n, m), S(m, m);
    std::vector<RunningError> lambda(m);
    for (int k = 0; k < m; ++k) {
      std::vector<RunningError> unit = setup.zeros();
      unit[coupled[k]] = 1;
      M_inverse_G.col(k) = forward(state, setup.zeros(), unit, Terms::none());
      lambda[k] = a_free(coupled[k], 0);
    }
    for (int k = 0; k < m; ++k) {
      for (int l = 0; l < m; ++l) S(k, l) = M_inverse_G(coupled[k], l);
      S(k, k) += RunningError(1) / setup.model.links[setup.model.link_of_dof[coupled[k]]].rotor;
    }
    recursive::factorize(S);
    recursive::solve(S, lambda);
    return a_free - M_inverse_G * column(lambda);
  }

  MatrixX<RunningError> forward(const scene::State<RunningError>& state,
                                const std::vector<RunningError>& qd,
                                const std::vector<RunningError>& tau, Terms terms) {
    std::vector<RunningError> qdd = setup.zeros();
    recursive::forwardDynamics(without_rotors.model, state.x, qd, tau, without_rotors.ws, qdd, terms);
    return column(qdd);
  }

  Setup<RunningError> setup, without_rotors;
  std::vector<int> coupled;  ///< degrees of freedom whose rotors are bodies of their own
};

EngineBound::EngineBound(const scene::Mechanism& mechanism, RotorsBy rotors)
    : impl_(std::make_unique<Impl>(mechanism, rotors)) {}
EngineBound::~EngineBound() = default;

Eigen::MatrixXd EngineBound::operator()(Quantity quantity, const scene::State<double>& state) {
  const scene::State<RunningError> bounded = runningErrorState(state);
  MatrixX<RunningError> computed;
  if (quantity != Quantity::kQdd)
    computed = NewtonEuler::answer(impl_->setup, quantity, bounded);
  else if (impl_->coupled.empty())
    computed = ArticulatedBody::answer(impl_->setup, quantity, bounded);
  else
    computed = impl_->accelerations(bounded);
  double largest = 0;
  for (Eigen::Index j = 0; j < computed.cols(); ++j)
    for (Eigen::Index i = 0; i < computed.rows(); ++i)
      largest = std::max(largest, computed(i, j).bound());
  return Eigen::MatrixXd::Constant(computed.rows(), computed.cols(), largest);
}

}  // namespace dynwitness::crosscheck
