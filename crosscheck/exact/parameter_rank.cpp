// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/exact/parameter_rank.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "crosscheck/scalars/formula_sizes.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/regressor.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {

std::vector<int> eliminationOrder(const std::vector<scene::InertialParameter>& parameters) {
  using Kind = scene::InertialParameter::Kind;
  std::vector<int> order(parameters.size());
  std::iota(order.begin(), order.end(), 0);
  const auto rank = [&](int j) {
    const Kind kind = parameters[j].kind;
    if (kind == Kind::kRotor) return std::pair(std::numeric_limits<int>::max(), 0);
    return std::pair(parameters[j].link, kind == Kind::kMass ? 2 : kind <= Kind::kHz ? 1 : 0);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return rank(a) < rank(b); });
  return order;
}

FieldSource regressorSource(const scene::Scene& scene, std::uint64_t seed, int trial, int k) {
  return {scene.name + ", state " + std::to_string(k), seed, static_cast<std::uint64_t>(trial)};
}

RegressorStack stackRegressor(const scene::Scene& scene,
                              const std::vector<scene::InertialParameter>& parameters,
                              std::uint64_t seed, int trial, Parameters given) {
  const FieldNumbers number(scene.mechanism, FieldSource(scene.name, seed, trial), given);
  const auto model = recursive::buildModel(scene.mechanism, number);
  recursive::Workspace<PrimeField> ws(model);
  recursive::MatrixX<PrimeField> Y(model.dof(), parameters.size());
  RegressorStack out{Echelon(eliminationOrder(parameters)), 0};
  scene::Work work("forces over the field", 1, 1);
  for (bool grows = true; grows; ++out.states) {
    const auto state =
        indeterminateState(scene.mechanism, regressorSource(scene, seed, trial, out.states));
    recursive::regressor(model, parameters, state.x, state.qd, state.qdd, ws, Y);
    grows = false;
    for (Eigen::Index i = 0; i < Y.rows(); ++i) {
      std::vector<PrimeField> row;
      for (Eigen::Index j = 0; j < Y.cols(); ++j) row.push_back(Y(i, j));
      grows = out.echelon.add(row) || grows;
      const double share = out.echelon.rank() / static_cast<double>(parameters.size());
      work.doneTo(share * share);  // a row costs as much as there are rows before it
    }
  }
  return out;
}

double chanceOfTooSmallRank(const scene::Scene& scene,
                            const std::vector<scene::InertialParameter>& parameters) {
  const FormulaSizes sizes;
  const FieldSource source(scene.name, 0, 0);
  const FieldNumbers number(scene.mechanism, source);
  const auto state = indeterminateState(scene.mechanism, source);
  const auto model = recursive::buildModel(scene.mechanism, number);
  recursive::Workspace<PrimeField> ws(model);
  recursive::MatrixX<PrimeField> Y(model.dof(), parameters.size());
  recursive::regressor(model, parameters, state.x, state.qd, state.qdd, ws, Y);
  PrimeField entry = 0, minor = 1;
  for (Eigen::Index i = 0; i < Y.rows(); ++i)
    for (Eigen::Index j = 0; j < Y.cols(); ++j) entry += Y(i, j);
  double terms = 0;  // log2 p!
  for (std::size_t k = 1; k <= parameters.size(); ++k) {
    minor *= entry;
    terms += std::log2(static_cast<double>(k));
  }
  for (int k = 0; k < terms; ++k) minor += minor;
  return (static_cast<double>(parameters.size()) + 1) * errorProbability(minor, sizes);
}

}  // namespace dynwitness::crosscheck
