// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_bound.hpp"

#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Adds an error of `times` u |largest entry| to every entry.
template <typename Derived>
void blur(Eigen::MatrixBase<Derived>& m, double times) {
  double largest = 0;
  for (const RunningError& x : m.reshaped()) largest = std::max(largest, std::abs(x.value()));
  const double error = times * RunningError::kUnitRoundoff * largest;
  for (RunningError& x : m.reshaped()) x = RunningError(x.value(), x.bound() + error);
}

constexpr double kQuaternionTurn = 20;  ///< [u], of an orientation that a quaternion gives

bool hasQuaternion(const recursive::LinkModel<RunningError>& link) {
  return recursive::axisCount(link.kind) >= 3;
}

/// The number of joints between the world and the link farthest from it.
int depth(const recursive::Model<RunningError>& model) {
  int deepest = 0;
  std::vector<int> of_link;
  for (const recursive::LinkModel<RunningError>& link : model.links) {
    of_link.push_back(link.parent < 0 ? 1 : of_link[link.parent] + 1);
    deepest = std::max(deepest, of_link.back());
  }
  return deepest;
}

recursive::Model<RunningError> inOtherAxes(recursive::Model<RunningError> model) {
  for (recursive::LinkModel<RunningError>& link : model.links) {
    blur(link.X_tree.R, hasQuaternion(link) ? 9 + kQuaternionTurn : 9);
    blur(link.X_tree.p, 6);
    blur(link.M.h, 3);
    recursive::Matrix3<RunningError> I = link.M.I.matrix();
    blur(I, 6);
    link.M.I = recursive::Symmetric3<RunningError>::fromUpper(I);
    blur(link.load.force, 3);
    blur(link.load.moment, 6);
  }
  for (recursive::WorldLoad<RunningError>& load : model.world_loads) {
    blur(load.force, 3);
    blur(load.moment, 3);
    blur(load.at, 3);
  }
  blur(model.gravity, 3);
  return model;
}

}  // namespace

struct EngineBound::Impl {
  Setup<RunningError> setup;
  ForwardDynamicsBy method;
};

EngineBound::EngineBound(const scene::Mechanism& mechanism, ForwardDynamicsBy method)
    : impl_(new Impl{Setup<RunningError>(inOtherAxes(recursive::buildModel(
                         mechanism, RunningErrorNumbers(mechanism), recursive::FixedJoints::kKept))),
                     method}) {}
EngineBound::~EngineBound() = default;

Eigen::MatrixXd EngineBound::operator()(Quantity quantity, const scene::State<double>& state) {
  return (*this)(quantity, runningErrorState(state));
}

Eigen::MatrixXd EngineBound::operator()(Quantity quantity,
                                        const scene::State<RunningError>& state) {
  scene::State<RunningError> bounded = state;
  bool turned = false;  // are there rates in axes that the engine does not have?
  for (const recursive::LinkModel<RunningError>& link : impl_->setup.model.links) {
    if (!hasQuaternion(link)) continue;
    turned = true;
    for (std::vector<RunningError>* rates : {&bounded.qd, &bounded.qdd, &bounded.tau})
      for (int k = 0; k < recursive::axisCount(link.kind) && !rates->empty(); k += 3) {
        Eigen::Map<recursive::Vector3<RunningError>> three(&(*rates)[link.dof + k]);
        blur(three, kQuaternionTurn + 3);
      }
  }
  MatrixX<RunningError> computed;
  if (quantity != Quantity::kQdd)
    computed = NewtonEuler::answer(impl_->setup, quantity, bounded);
  else if (impl_->method == ForwardDynamicsBy::kSweep)
    computed = ArticulatedBody::answer(impl_->setup, quantity, bounded);
  else
    computed = CompositeBody::answer(impl_->setup, quantity, bounded);
  double largest = 0, size = 0;
  for (Eigen::Index j = 0; j < computed.cols(); ++j) {
    for (Eigen::Index i = 0; i < computed.rows(); ++i) {
      largest = std::max(largest, computed(i, j).bound());
      size = std::max(size, std::abs(computed(i, j).value()));
    }
  }
  if (quantity == Quantity::kReactions)
    largest = 2 * largest + (9 * depth(impl_->setup.model) + 3) * RunningError::kUnitRoundoff * size;
  if (turned) largest = 2 * largest + (kQuaternionTurn + 3) * RunningError::kUnitRoundoff * size;
  return Eigen::MatrixXd::Constant(computed.rows(), computed.cols(), largest);
}

}  // namespace dynwitness::crosscheck
