// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/diagnosis/exhibits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/scalars/ball.hpp"
#include "crosscheck/witnesses/solve_bound.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

/// Wide enough for the distance between an answer and a truth.
constexpr long kDistanceBits = 256;
constexpr double kMostDigits = std::numeric_limits<double>::max_digits10;

double inSingle(double x) {
  return static_cast<double>(static_cast<float>(x));
}

}  // namespace

std::vector<scene::State<double>> chosenStates(const scene::Mechanism& mechanism,
                                               const std::string& name, std::uint64_t seed,
                                               bool single) {
  std::vector<scene::State<double>> drawn;
  for (int k = 0; k < 4; ++k)
    drawn.push_back(drawState(mechanism, name, seed, static_cast<std::uint64_t>(k)));
  const std::vector<double> zeros(drawn[0].qd.size(), 0.0);
  std::vector<scene::State<double>> out = {drawn[0], drawn[1], drawn[2], drawn[0], drawn[0],
                                           drawn[0], drawn[0], drawn[0], drawn[1], drawn[3]};
  for (const int k : {kStill, kPushed}) out[static_cast<std::size_t>(k)].qd = zeros;
  for (const int k : {kStill, kMoving, kBackward, kFaster})
    out[static_cast<std::size_t>(k)].qdd = zeros;
  for (double& rate : out[kBackward].qd) rate = -rate;
  for (double& rate : out[kFaster].qd) rate *= 2;
  const scene::RealNumbers<double> number(mechanism);
  const std::vector<scene::Number> rest = mechanism.restPosition();
  for (std::size_t i = 0; i < rest.size(); ++i) out[8].x[i] = scene::jointPosition(number(rest[i]));
  if (single)
    for (scene::State<double>& state : out) {
      for (auto& x : state.x) x = scene::jointPosition(inSingle(x.q));
      for (auto* part : {&state.qd, &state.qdd, &state.tau})
        for (double& x : *part) x = inSingle(x);
    }
  return out;
}

bool isAskedAt(Quantity quantity, int state) {
  const bool varies = state < kStill || state > kFaster;
  switch (quantity) {
    case Quantity::kM:
    case Quantity::kg:
    case Quantity::kPotential:
    case Quantity::kQdd:
      return varies;
    case Quantity::kc:
    case Quantity::kKinetic:
    case Quantity::kMomentum:
      return varies || state >= kMoving;
    default:
      return true;
  }
}

Bench::Bench(const scene::Scene& scene, Witness& witness, double factor)
    : witness_(witness),
      factor_(factor),
      bound_(scene.mechanism),
      truth_(scene.mechanism),
      backward_error_(scene.mechanism) {}

Exhibit Bench::ask(Quantity quantity, const scene::State<double>& state, int index) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  Exhibit out;
  out.asked = out.compared = quantity;
  out.index = index;
  out.state = state;
  const BallPrecision precision(kDistanceBits);
  const Certified exact = truth_(quantity, state);
  if (!exact.exists()) {
    out.failure = "no certified truth: " + exact.reason;
    out.is_impossible = exact.is_impossible;
    return out;
  }
  Answer answer;
  try {
    answer = witness_.answer(quantity, state);
  } catch (const std::exception& error) {
    out.failure = error.what();
    return out;
  }
  MatrixX<Ball> distance;
  const auto middles = [](const MatrixX<Ball>& m) {
    return Eigen::MatrixXd(m.unaryExpr([](const Ball& x) { return x.mid(); }));
  };
  double size = 0, off = 0;
  for (Eigen::Index k = 0; k < exact.value.size(); ++k) {
    const Ball& x = exact.value.data()[k];
    const Ball d = Ball(answer.value.data()[k]) - x;
    size = std::max(size, x.atLeast());
    off = std::max(off, d.isFinite() ? d.atMost() : kInfinite);
  }
  out.size = size;
  out.digits = off == 0   ? kMostDigits
               : size > 0 ? std::clamp(-std::log10(off / size), 0.0, kMostDigits)
                          : 0;
  if (quantity == Quantity::kQdd && answer.residual_bound.size() > 0) {
    backward_error_.at(state);
    const Residual residual = backward_error_(answer.value);
    distance = residual.value;
    out.compared = Quantity::kTau;
    out.state = moving(state, answer.value);
    out.said = Eigen::Map<const Eigen::VectorXd>(state.tau.data(),
                                                 static_cast<Eigen::Index>(state.tau.size()));
    out.truth = out.said + middles(distance);
    out.bound = factor_ * answer.residual_bound;
    out.sweep_bound = out.bound.cwiseMax(factor_ * bound_(Quantity::kTau, out.state));
    out.size = residual.size;
  } else {
    distance = MatrixX<Ball>(answer.value.rows(), answer.value.cols());
    for (Eigen::Index k = 0; k < distance.size(); ++k)
      distance.data()[k] = Ball(answer.value.data()[k]) - exact.value.data()[k];
    out.said = answer.value;
    out.truth = middles(exact.value);
    out.bound = out.sweep_bound = factor_ * answer.bound;
  }
  out.error = distance.unaryExpr(
      [](const Ball& ball) { return ball.isFinite() ? ball.atLeast() : kInfinite; });
  if (!out.bound.allFinite()) {
    out.failure = "no bound of what rounding may lose at this state";
    return out;
  }
  out.is_wrong = (out.error.array() > out.bound.array()).any();
  return out;
}

}  // namespace dynwitness::crosscheck
