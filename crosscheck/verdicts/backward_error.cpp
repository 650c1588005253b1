// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/backward_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Eigenvalues>

#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Balls are narrow enough when they are this far below an ulp.
constexpr double kNarrow = 0x1p-20;

double widest(const MatrixX<Ball>& value) {
  double radius = 0;
  for (const Ball& x : value.reshaped())
    radius = std::max(radius, x.isFinite() ? x.radius() : std::numeric_limits<double>::infinity());
  return radius;
}

}  // namespace

struct BackwardError::Impl {
  explicit Impl(const PreparedScene& scene)
      : mechanism(scene.mechanism()), numbers(mechanism), in_double(scene.model<double>()) {}

  Setup<Ball>& setup() {
    std::unique_ptr<Setup<Ball>>& slot = setups[BallPrecision::bits()];
    if (!slot) slot = std::make_unique<Setup<Ball>>(mechanism, numbers);
    return *slot;
  }

  scene::Mechanism mechanism;
  BallNumbers numbers;
  Setup<double> in_double;
  std::map<long, std::unique_ptr<Setup<Ball>>> setups;  ///< by precision
  long bits = 128;                                      ///< that were enough so far
  scene::State<double> state;
  Eigen::MatrixXd M, without_qdd;  ///< without_qdd: c + g + friction - Q
};

BackwardError::BackwardError(const PreparedScene& scene) : impl_(new Impl(scene)) {}
BackwardError::~BackwardError() = default;

void BackwardError::at(const scene::State<double>& state) {
  impl_->state = state;
  impl_->M = CompositeBody::answer(impl_->in_double, Quantity::kM, state);
  impl_->without_qdd =
      impl_->in_double.inverse(state, state.qd, impl_->in_double.zeros(), Terms::all());
}

Residual BackwardError::operator()(const Eigen::MatrixXd& qdd) {
  Impl& s = *impl_;
  const Eigen::Map<const Eigen::VectorXd> tau(s.state.tau.data(),
                                              static_cast<Eigen::Index>(s.state.tau.size()));
  Residual out;
  if (qdd.rows() != tau.rows() || qdd.cols() != 1 || !qdd.allFinite()) {
    const Ball nothing(std::numeric_limits<double>::quiet_NaN());
    out.value = MatrixX<Ball>::Constant(tau.rows(), 1, nothing);
    out.size = 1;
    return out;
  }
  const Eigen::VectorXd terms =
      tau.cwiseAbs() + s.without_qdd.cwiseAbs() + s.M.cwiseAbs() * qdd.cwiseAbs();
  out.size = terms.maxCoeff() > 0 ? terms.maxCoeff() : 1.0;
  scene::State<double> answered = s.state;
  answered.qdd.assign(qdd.data(), qdd.data() + qdd.size());
  for (;; s.bits *= 2) {
    const BallPrecision precision(s.bits);
    const scene::State<Ball> exactly = ballState(answered, s.mechanism);
    out.value = NewtonEuler::answer(s.setup(), Quantity::kTau, exactly) - column(exactly.tau);
    if (widest(out.value) < kNarrow * kEpsilon * out.size || 2 * s.bits > kMaxBits) return out;
  }
}

double BackwardError::condition() const {
  const Eigen::VectorXd root =
      impl_->M.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  const Eigen::MatrixXd scaled =
      root.cwiseInverse().asDiagonal() * impl_->M * root.cwiseInverse().asDiagonal();
  const Eigen::VectorXd lambda =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
  const double largest = lambda.maxCoeff();
  return largest / std::max(lambda.minCoeff(), kEpsilon * largest);
}

}  // namespace dynwitness::crosscheck
