// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/estimated_sweep.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/rounding_estimate.hpp"

namespace dynwitness::crosscheck {
namespace {

template <typename T>
scene::State<T> told(const scene::State<double>& state) {
  const auto all = [](const std::vector<double>& v) { return std::vector<T>(v.begin(), v.end()); };
  scene::State<T> out{{}, all(state.qd), all(state.qdd), all(state.tau)};
  for (const scene::JointPosition<double>& x : state.x)
    if constexpr (std::is_same_v<T, double>)
      out.x.push_back(x);
    else
      out.x.push_back(scene::jointPosition(static_cast<T>(x.q)));
  return out;
}

/// One sweep and its estimate, sharing a model.
template <typename T>
struct Estimating {
  explicit Estimating(const scene::Mechanism& mechanism)
      : setup(recursive::buildModel(mechanism, scene::RealNumbers<T>(mechanism))),
        estimate(setup.model, !std::is_same_v<T, double>) {}

  Setup<T> setup;
  recursive::RoundingEstimate<T> estimate;
};

template <typename T>
EstimatedAnswer answered(const MatrixX<T>& value, T error) {
  // what is not a number has no digits, whatever was estimated of it
  const bool is_number = value.allFinite() && !std::isnan(error);
  return {value.template cast<double>(), is_number ? -std::log10(static_cast<double>(error))
                                                   : -std::numeric_limits<double>::infinity()};
}

template <typename T>
EstimatedAnswer byNewtonEuler(Estimating<T>& e, Quantity quantity, scene::State<T> state) {
  Terms terms = Terms::all();
  if (quantity != Quantity::kTau) {
    terms = quantity == Quantity::kc ? Terms::none() : Terms::potential();
    state.qdd = e.setup.zeros();
    if (quantity == Quantity::kg) state.qd = state.qdd;
  }
  std::vector<T> tau = e.setup.zeros();
  recursive::inverseDynamics(e.setup.model, state.x, state.qd, state.qdd, e.setup.ws, tau, terms);
  return answered<T>(column(tau),
                     e.estimate.inverseDynamics(state.x, state.qd, state.qdd, tau, terms));
}

template <typename T>
EstimatedAnswer byArticulatedBody(Estimating<T>& e, const scene::State<T>& state) {
  std::vector<T> qdd = e.setup.zeros();
  recursive::forwardDynamics(e.setup.model, state.x, state.qd, state.tau, e.setup.ws, qdd);
  return answered<T>(column(qdd), e.estimate.forwardDynamics(e.setup.model, state.x, state.qd,
                                                             state.tau, e.setup.ws, qdd));
}

template <typename T>
EstimatedAnswer byCompositeBody(Estimating<T>& e, Quantity quantity, const scene::State<T>& state) {
  Setup<T>& s = e.setup;
  MatrixX<T> M(s.model.dof(), s.model.dof());
  recursive::massMatrix(s.model, state.x, s.ws, M);
  if (quantity == Quantity::kM) return answered<T>(M, e.estimate.massMatrix(state.x, M));
  std::vector<T> qdd = s.zeros();
  recursive::inverseDynamics(s.model, state.x, state.qd, s.zeros(), s.ws, qdd);
  for (std::size_t i = 0; i < qdd.size(); ++i) qdd[i] = state.tau[i] - qdd[i];
  recursive::factorize(M);
  recursive::solve(M, qdd);
  return answered<T>(column(qdd), e.estimate.solved(state.x, state.qd, state.tau, M, qdd));
}

template <typename T>
EstimatedSweep inNumbers(const std::string& witness, Quantity quantity,
                         const scene::Mechanism& mechanism) {
  const bool is_force =
      quantity == Quantity::kTau || quantity == Quantity::kc || quantity == Quantity::kg;
  const bool is_newton_euler = witness == NewtonEuler::kName && is_force,
             is_composite = witness == CompositeBody::kName &&
                            (quantity == Quantity::kM || quantity == Quantity::kQdd),
             is_articulated = witness == ArticulatedBody::kName && quantity == Quantity::kQdd;
  if (!is_newton_euler && !is_composite && !is_articulated) return {};
  const auto e = std::make_shared<Estimating<T>>(mechanism);
  if (is_articulated && e->setup.model.coupled) return {};
  return [e, quantity, is_newton_euler, is_composite](const scene::State<double>& state) {
    if (is_newton_euler) return byNewtonEuler(*e, quantity, told<T>(state));
    if (is_composite) return byCompositeBody(*e, quantity, told<T>(state));
    return byArticulatedBody(*e, told<T>(state));
  };
}

}  // namespace

EstimatedSweep estimatedSweep(const std::string& witness, Quantity quantity,
                              const scene::Mechanism& mechanism, bool in_float) {
  return in_float ? inNumbers<float>(witness, quantity, mechanism)
                  : inNumbers<double>(witness, quantity, mechanism);
}

}  // namespace dynwitness::crosscheck
