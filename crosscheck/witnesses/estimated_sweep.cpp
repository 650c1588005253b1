// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/estimated_sweep.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>
#include <vector>

#include "crosscheck/witnesses/certain_digits.hpp"
#include "crosscheck/witnesses/fast_sweeps.hpp"
#include "crosscheck/witnesses/kernel_names.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/fast/warned_dynamics.hpp"
#include "recursive/rounding_filter.hpp"

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

double suspicious() {
  return std::pow(10.0, -kFewestDigits);
}

/// One sweep and its estimate, sharing a model.
template <typename T>
struct Estimating {
  explicit Estimating(const scene::Mechanism& mechanism)
      : setup(recursive::buildModel(mechanism, scene::RealNumbers<T>(mechanism))),
        estimate(setup.model, static_cast<T>(suspicious()), !std::is_same_v<T, double>) {}

  Setup<T> setup;
  recursive::RoundingFilter<T> estimate;
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
  return answered<T>(column(tau), e.estimate.inverseDynamics(state.x.data(), state.qd.data(),
                                                             state.qdd.data(), tau.data(), terms));
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
  if (quantity == Quantity::kM)
    return answered<T>(M, e.estimate.massMatrix(state.x.data(), [&](int d) { return M(d, d); }));
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

EstimatedSweep byFastSweeps(Quantity quantity, const scene::Mechanism& mechanism) {
  if (!FastSweeps<double>::answers(quantity)) return {};
  const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  if (model.coupled) return {};
  const auto sweeps = std::make_shared<recursive::fast::WarnedDynamics>(model, suspicious());
  return [sweeps, quantity](const scene::State<double>& state) {
    std::vector<double> q;
    for (const scene::JointPosition<double>& x : state.x) q.push_back(x.q);
    const auto n = static_cast<Eigen::Index>(state.qd.size());
    Eigen::MatrixXd out(n, quantity == Quantity::kM ? n : 1);
    const double *qd = state.qd.data(), *qdd = state.qdd.data(), *tau = state.tau.data();
    const double error = quantity == Quantity::kM ? sweeps->massMatrix(q.data(), out.data())
                         : quantity == Quantity::kTau
                             ? sweeps->inverseDynamics(q.data(), qd, qdd, out.data())
                             : sweeps->forwardDynamics(q.data(), qd, tau, out.data());
    return answered<double>(out, error);
  };
}

}  // namespace

EstimatedSweep estimatedKernel(Witness& witness, Quantity quantity,
                               const scene::Mechanism& mechanism) {
  const bool is_kernel = witness.name() == kKernelName || witness.name() == kKernelLanesName;
  if (!is_kernel || (quantity != Quantity::kTau && quantity != Quantity::kM)) return {};
  const auto model = recursive::buildModel(mechanism, scene::RealNumbers<double>(mechanism));
  if (model.coupled) return {};
  const auto filter = std::make_shared<recursive::RoundingFilter<double>>(model, suspicious());
  return [filter, quantity, &witness](const scene::State<double>& state) {
    const Eigen::MatrixXd value = witness.value(quantity, state);
    const double error =
        quantity == Quantity::kM
            ? filter->massMatrix(state.x.data(), [&](int d) { return value(d, d); })
            : filter->inverseDynamics(state.x.data(), state.qd.data(), state.qdd.data(),
                                      value.data());
    return answered<double>(value, error);
  };
}

EstimatedSweep estimatedSweep(const std::string& witness, Quantity quantity,
                              const scene::Mechanism& mechanism, bool in_float) {
  if (witness == kFastName && !in_float) return byFastSweeps(quantity, mechanism);
  return in_float ? inNumbers<float>(witness, quantity, mechanism)
                  : inNumbers<double>(witness, quantity, mechanism);
}

}  // namespace dynwitness::crosscheck
