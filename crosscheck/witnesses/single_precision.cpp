// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/single_precision.hpp"

#include <memory>

#include "crosscheck/scalars/single_error.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {
namespace {

/// The state in float, with the C library's cosf and sinf, whatever their errors are: measured
/// against cosine and sine of the position as it is told.
scene::State<SingleError> inSingle(const scene::State<double>& told,
                                   const scene::Mechanism& mechanism) {
  const scene::State<RunningError> known = runningErrorState(told, mechanism);
  scene::State<SingleError> state;
  for (std::size_t k = 0; k < told.x.size(); ++k) {
    const scene::JointPosition<float> x = scene::jointPosition(static_cast<float>(told.x[k].q));
    state.x.push_back({{x.q, known.x[k].q}, {x.c, known.x[k].c}, {x.s, known.x[k].s}});
  }
  state.qd.assign(told.qd.begin(), told.qd.end());
  state.qdd.assign(told.qdd.begin(), told.qdd.end());
  state.tau.assign(told.tau.begin(), told.tau.end());
  return state;
}

template <typename Algorithm>
SingleSweep swept(const scene::Mechanism& mechanism) {
  const auto setup = std::make_shared<Setup<SingleError>>(mechanism, SingleErrorNumbers(mechanism));
  return [setup, mechanism](Quantity quantity, const scene::State<double>& state) {
    const MatrixX<SingleError> found =
        Algorithm::answer(*setup, quantity, inSingle(state, mechanism));
    return Answer{found.unaryExpr([](const SingleError& x) -> double { return x.value(); }),
                  found.unaryExpr([](const SingleError& x) { return x.bound(); })};
  };
}

}  // namespace

SingleSweep sweepInSinglePrecision(const std::string& witness, const scene::Mechanism& mechanism) {
  if (witness == NewtonEuler::kName) return swept<NewtonEuler>(mechanism);
  if (witness == CompositeBody::kName) return swept<CompositeBody>(mechanism);
  if (witness == ArticulatedBody::kName) return swept<ArticulatedBody>(mechanism);
  return {};
}

}  // namespace dynwitness::crosscheck
