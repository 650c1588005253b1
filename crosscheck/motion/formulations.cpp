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

/// Without runs: what they are to be measured against.
FormulationComparison withReference(const scene::Scene& scene, const SimulateOptions& options) {
  constexpr double kLeastStepError = 1000 * std::numeric_limits<double>::epsilon();
  FormulationComparison out;
  out.reference = options;
  out.reference.formulation = Formulation::kIndex1;
  out.reference.stabilisation = Stabilisation::kProjection;
  out.reference.method = "runge_kutta_fehlberg78";
  out.reference.step_error = kLeastStepError;
  out.reference_run = simulate(scene, out.reference);
  for (const Simulation::Point& point : out.reference_run.points)
    for (std::size_t i = 0; i < point.lambda.size(); ++i)
      if (point.determined[i])
        out.most_lambda = std::max(out.most_lambda, std::abs(point.lambda[i]));
  return out;
}

FormulationRun runOf(const scene::Scene& scene, const SimulateOptions& options,
                     const Simulation& reference) {
  FormulationRun run;
  run.formulation = options.formulation;
  run.stabilisation = options.stabilisation;
  run.method = options.method;
  if (needsPositions(run.formulation) && scene.mechanism.hasClosuresOfRates()) {
    run.failure = "closures of rates alone (skate, rolling) have no phi = 0 to solve for";
    return run;
  }
  try {
    run.result = simulate(scene, options);
    measure(reference, &run);
  } catch (const std::runtime_error& error) {
    if (dynamic_cast<const scene::InputError*>(&error)) throw;
    run.failure = error.what();
  }
  return run;
}

}  // namespace

FormulationComparison compareFormulations(const scene::Scene& scene,
                                          const SimulateOptions& options) {
  FormulationComparison out = withReference(scene, options);

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
    SimulateOptions with = options;
    with.formulation = formulation;
    with.stabilisation = stabilisation;
    with.method = method;
    out.runs.push_back(runOf(scene, with, out.reference_run));
  }
  return out;
}

FormulationComparison compareMethods(const scene::Scene& scene, const SimulateOptions& options,
                                     const std::vector<std::string>& methods) {
  for (const std::string& method : methods) hasEqualSteps(method);  // refuses unknown ones first
  FormulationComparison out = withReference(scene, options);
  SimulateOptions with = options;
  for (const std::string& method : methods) {
    with.method = method;
    out.runs.push_back(runOf(scene, with, out.reference_run));
  }
  return out;
}

}  // namespace dynwitness::crosscheck
