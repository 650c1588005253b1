// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/verdicts/check_second_derivatives.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "crosscheck/inputs/states.hpp"
#include "crosscheck/laws/narrow_sides.hpp"
#include "crosscheck/laws/second_derivative_pairs.hpp"
#include "crosscheck/verdicts/identity_tallies.hpp"
#include "crosscheck/verdicts/tally.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/build_model.hpp"
#include "recursive/second_derivatives.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr std::size_t kOfForces = 4;  ///< the first of SecondDerivative

/// Those of tau, n x n^2 each.
template <typename T>
std::array<MatrixX<T>, kOfForces> ofForces(const recursive::Model<T>& model,
                                           const scene::State<T>& state) {
  recursive::SecondDerivativesWorkspace<T> room(model);
  recursive::InverseDynamicsSecondDerivatives<T> of(model);
  recursive::inverseDynamicsSecondDerivatives(model, state.x, state.qd, state.qdd, room, of);
  const int n = model.dof();
  std::array<MatrixX<T>, kOfForces> out;
  for (std::size_t k = 0; k < kOfForces; ++k) {
    out[k] = MatrixX<T>::Constant(n, n * n, T(0));
    for (int j = 0; j < n; ++j) out[k].middleCols(j * n, n) = of.all()[k]->slab(j);
  }
  return out;
}

/// The precision is doubled until all are known to 2^-20 of an ulp, or is at its end.
std::array<MatrixX<Ball>, kOfForces> inBalls(const scene::Mechanism& mechanism,
                                             const scene::State<double>& state) {
  for (long bits = kFirstBits;; bits *= 2) {
    const BallPrecision precision(bits);
    auto out = ofForces(recursive::buildModel(mechanism, BallNumbers(mechanism)),
                        ballState(state, mechanism));
    const auto narrow = [](const MatrixX<Ball>& m) {
      return isNarrow({m, MatrixX<Ball>::Constant(m.rows(), m.cols(), Ball(0.0))});
    };
    if (2 * bits > kMostBits || std::all_of(out.begin(), out.end(), narrow)) return out;
  }
}

CheckResult described(std::size_t quantity, CheckKind kind, std::uint64_t seed) {
  CheckResult check;
  check.kind = kind;
  check.quantity = kSecondDerivativeNames[quantity];
  check.left = "derivatives";
  check.statement = fmt::format(
      kind == CheckKind::kTruth ? "|{} by {} - truth| <= its error bound" : "{1} answers {0}",
      check.quantity, check.left);
  check.seed = seed;
  return check;
}

}  // namespace

std::vector<CheckResult> checkSecondDerivatives(const PreparedScene& prepared,
                                                const Options& options,
                                                const PreparedScene* answering) {
  const scene::Mechanism& mechanism = prepared.mechanism();
  const PreparedScene& in_double = answering == nullptr ? prepared : *answering;
  std::vector<CheckResult> results;
  if (const std::string reason = whyNoSecondSweep(mechanism); !reason.empty()) {
    for (std::size_t k = 0; k < kSecondDerivativeNames.size(); ++k) {
      results.push_back(described(k, CheckKind::kWitness, options.seed));
      results.back().verdict = Verdict::kNotAnswerable;
      results.back().reason = reason;
    }
    return results;
  }
  scene::Work work("second derivatives", 1);
  const scene::State<double> state = drawState(mechanism, prepared.scene().name, options.seed, 0);
  const auto said = ofForces(in_double.model<double>(), state);
  const auto bounded =
      ofForces(in_double.model<RunningError>(), runningErrorState(state, mechanism));
  const auto truth = inBalls(mechanism, state);
  const BallPrecision precision(kFirstBits);
  for (std::size_t k = 0; k < kOfForces; ++k) {
    const MatrixX<Ball> distance = said[k].unaryExpr([](double x) { return Ball(x); }) - truth[k];
    const Eigen::Index n = truth[k].rows();
    Tally tally(described(k, CheckKind::kTruth, options.seed),
                [n, quantity = kSecondDerivativeNames[k]](Eigen::Index i, Eigen::Index column) {
                  return fmt::format("{}[{},{},{}]", quantity, i + 1, column / n + 1,
                                     column % n + 1);
                });
    // where the truth itself is not known, the limit is as wide
    const Eigen::MatrixXd limit = bounded[k].unaryExpr([](const RunningError& x) {
      return x.bound();
    }) + distance.unaryExpr([](const Ball& x) { return x.radius(); });
    tally.addDifference(0, distance.unaryExpr([](const Ball& x) { return x.mid(); }), limit,
                        largestOf(truth[k]));
    results.push_back(tally.result());
    results.back().digits = digitsLeft(distance, truth[k]);
  }
  work.done();
  return results;
}

}  // namespace dynwitness::crosscheck
