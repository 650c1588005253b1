// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/motion/formulations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dynwitness::crosscheck {

const char* name(Formulation formulation) {
  static constexpr const char* kNames[] = {"index1", "index2", "index3", "ggl"};
  return kNames[static_cast<int>(formulation)];
}

const char* name(Stabilisation stabilisation) {
  static constexpr const char* kNames[] = {"none", "baumgarte", "projection"};
  return kNames[static_cast<int>(stabilisation)];
}

namespace {

void measure(const Simulation& reference, FormulationRun* run) {
  const MotionGap gap = gapBetween(run->result, reference);
  run->q_error = gap.q;
  run->qd_error = gap.qd;
  double worst = 0;
  for (std::size_t k = 1; k < reference.points.size(); ++k) {
    const Simulation::Point &right = reference.points[k], &ours = run->result.points[k];
    for (std::size_t i = 0; i < right.lambda.size(); ++i) {
      if (!right.determined[i]) continue;
      const double error = std::abs(ours.lambda[i] - right.lambda[i]);
      if (!(error <= worst)) worst = error;  // NaN counts as the worst
      run->lambda_error = worst;
    }
  }
}

}  // namespace

FormulationComparison compareFormulations(const scene::Scene& scene,
                                          const SimulateOptions& options) {
  constexpr double kLeastStepError = 1000 * std::numeric_limits<double>::epsilon();
  FormulationComparison out;
  out.reference = options;
  out.reference.formulation = Formulation::kIndex1;
  out.reference.stabilisation = Stabilisation::kProjection;
  out.reference.method = "runge_kutta_fehlberg78";
  out.reference.step_error = kLeastStepError;
  const Simulation reference = simulate(scene, out.reference);
  for (const Simulation::Point& point : reference.points)
    for (std::size_t i = 0; i < point.lambda.size(); ++i)
      if (point.determined[i])
        out.most_lambda = std::max(out.most_lambda, std::abs(point.lambda[i]));

  const std::string implicit = knowsFormulations(options.method) ? options.method : "radau_iia_5";
  const std::string explicit_one =
      options.method == implicit ? "runge_kutta_fehlberg78" : options.method;
  using F = Formulation;
  using S = Stabilisation;
  const std::tuple<F, S, std::string> all[kComparedFormulations] = {
      {F::kIndex1, S::kNone, explicit_one},       {F::kIndex1, S::kBaumgarte, explicit_one},
      {F::kIndex1, S::kProjection, explicit_one}, {F::kIndex1, S::kNone, implicit},
      {F::kIndex1, S::kProjection, implicit},     {F::kIndex2, S::kNone, implicit},
      {F::kIndex3, S::kNone, implicit},           {F::kGgl, S::kNone, implicit}};
  for (const auto& [formulation, stabilisation, method] : all) {
    FormulationRun run;
    run.formulation = formulation;
    run.stabilisation = stabilisation;
    run.method = method;
    SimulateOptions with = options;
    with.formulation = formulation;
    with.stabilisation = stabilisation;
    with.method = method;
    if (needsPositions(formulation) && scene.mechanism.hasClosuresOfRates()) {
      run.failure = "closures of rates alone (skate, rolling) have no phi = 0 to solve for";
      out.runs.push_back(std::move(run));
      continue;
    }
    try {
      run.result = simulate(scene, with);
      measure(reference, &run);
    } catch (const std::runtime_error& error) {
      if (dynamic_cast<const scene::InputError*>(&error)) throw;
      run.failure = error.what();
    }
    out.runs.push_back(std::move(run));
  }
  return out;
}

}  // namespace dynwitness::crosscheck
