// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/regressor_checks.hpp"

#include <memory>

#include "crosscheck/exact/inquiry.hpp"
#include "recursive/regressor.hpp"
#include "symbolic/program.hpp"
#include "symbolic/regressor.hpp"

namespace dynwitness::crosscheck {
namespace {

template <typename Numbers, typename T = typename Numbers::Scalar>
TwoSides<T> sides(const scene::Mechanism& mechanism, const symbolic::Program& derived,
                  const Numbers& number, const scene::State<T>& state) {
  const auto parameters = scene::inertialParameters(mechanism);
  const auto model = recursive::buildModel(mechanism, number);
  recursive::Workspace<T> ws(model);
  MatrixX<T> Y(model.dof(), parameters.size());
  recursive::regressor(model, parameters, state.x, state.qd, state.qdd, ws, Y);
  TwoSides<T> out{MatrixX<T>(Y.cols(), 1), MatrixX<T>(Y.cols(), 1)};
  const std::vector<T> values = symbolic::ProgramRun<T>(derived, number)(state);
  for (Eigen::Index j = 0; j < Y.cols(); ++j) {
    T sum = T(0);
    for (Eigen::Index i = 0; i < Y.rows(); ++i) sum += state.tau[i] * Y(i, j);
    out.left(j, 0) = sum;
    out.right(j, 0) = values[j];
  }
  return out;
}

}  // namespace

std::vector<CheckResult> checkRegressorExactly(const scene::Scene& scene,
                                               const ExactOptions& options,
                                               const scene::Mechanism* derived_from) {
  Inquiry inquiry;
  CheckResult check;
  check.law = "regressor";
  check.statement = "w' Y by the sweeps = w' dtau/dpi by lagrange, for any w";
  check.quantity = "Y";
  check.left = "sweeps";
  check.right = "lagrange";
  inquiry.checks = {check};
  symbolic::InertialSymbols symbols =
      symbolic::inertialSymbols(derived_from ? *derived_from : scene.mechanism);
  const std::vector<symbolic::Node> outputs = symbolic::weightedRegressor(symbols);
  const auto derived = std::make_shared<const symbolic::Program>(
      symbolic::compile(symbols.equations.graph, outputs));
  scene::Scene asked = scene;  // numbers for both sides: the scene's, and the symbols
  asked.mechanism.parameters = symbols.mechanism.parameters;
  inquiry.ask = [&scene, derived](const FieldNumbers& number, const scene::State<PrimeField>& state,
                                  const std::vector<char>&) {
    try {
      return SidesOfAll{sides(scene.mechanism, *derived, number, state)};
    } catch (const std::domain_error& error) {
      return SidesOfAll{{{}, {}, error.what()}};
    }
  };
  return decide(asked, inquiry, options);
}

}  // namespace dynwitness::crosscheck
