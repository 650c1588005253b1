// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/laws/identities_in_balls.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "crosscheck/laws/compiled_identities.hpp"
#include "crosscheck/laws/narrow_sides.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {

DYNWITNESS_IDENTITIES(, Ball);

struct IdentitiesInBalls::Impl {
  scene::Mechanism mechanism;
  std::map<long, std::unique_ptr<SweptMechanism<Ball>>> swept;  ///< by precision
  long bits = kFirstBits;                                       ///< that were enough so far
};

IdentitiesInBalls::IdentitiesInBalls(const scene::Mechanism& mechanism)
    : impl_(new Impl{mechanism, {}}) {}
IdentitiesInBalls::~IdentitiesInBalls() = default;

std::vector<TwoSides<Ball>> IdentitiesInBalls::operator()(const scene::State<double>& state) {
  for (;; impl_->bits *= 2) {
    const BallPrecision precision(impl_->bits);
    auto& swept = impl_->swept[impl_->bits];
    if (!swept)
      swept =
          std::make_unique<SweptMechanism<Ball>>(impl_->mechanism, BallNumbers(impl_->mechanism));
    std::vector<TwoSides<Ball>> sides =
        Identities::sides(impl_->mechanism, swept->at(ballState(state, impl_->mechanism)));
    if (2 * impl_->bits > kMostBits || std::all_of(sides.begin(), sides.end(), isNarrow))
      return sides;
  }
}

struct PositivePivots::Impl {
  scene::Mechanism mechanism;
  std::map<long, std::unique_ptr<Setup<Ball>>> setups;  ///< by precision
};

PositivePivots::PositivePivots(const scene::Mechanism& mechanism)
    : impl_(new Impl{mechanism, {}}) {}
PositivePivots::~PositivePivots() = default;

double PositivePivots::operator()(const scene::State<double>& state) {
  double worst = std::numeric_limits<double>::infinity();
  for (long bits = kFirstBits; bits <= kMostBits; bits *= 2) {
    const BallPrecision precision(bits);
    std::unique_ptr<Setup<Ball>>& setup = impl_->setups[bits];
    if (!setup)
      setup = std::make_unique<Setup<Ball>>(impl_->mechanism, BallNumbers(impl_->mechanism));
    MatrixX<Ball> M =
        CompositeBody::answer(*setup, Quantity::kM, ballState(state, impl_->mechanism));
    recursive::factorize(M);
    worst = 0;
    for (Eigen::Index i = 0; i < M.rows(); ++i) {
      const Ball& D = M(i, i);
      if (D.isFinite() && !D.containsZero() && !D.isPositive())
        return std::numeric_limits<double>::infinity();
      worst = D.isFinite() && D.isPositive() ? std::max(worst, D.radius() / D.atLeast())
                                             : std::numeric_limits<double>::infinity();
      if (!(worst < 1)) break;
    }
    if (worst < 1) return worst;
  }
  return worst;
}

}  // namespace dynwitness::crosscheck
