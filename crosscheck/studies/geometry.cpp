// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/geometry.hpp"

#include <optional>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/kinetic_metric.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {

namespace {

using Error = RunningError;

/// Two kinds of Christoffel symbols with their bounds take 32 n^3 bytes: 0.5 GB.
constexpr int kMostMetricJoints = 256;

Bounded split(const MatrixOf<Error>& m) {
  return {m.unaryExpr([](const Error& e) { return e.value(); }),
          m.unaryExpr([](const Error& e) { return e.bound(); })};
}

}  // namespace

MetricAt metricAt(const scene::Scene& scene, const std::vector<double>& q) {
  requireTreated(scene, Command::kGeometry);
  requireMotion(scene);
  if (static_cast<int>(q.size()) != scene.mechanism.dof())
    throw scene::InputError(
        {}, fmt::format("q: {} values, allowed: {}", q.size(), scene.mechanism.dof()));
  if (scene.mechanism.dof() > kMostMetricJoints)
    throw scene::InputError(
        {scene.file.string()},
        fmt::format("has {0} joints and {0}^3 Christoffel symbols of each kind, raised by {0}^4 "
                    "operations; allowed: {1} joints",
                    scene.mechanism.dof(), kMostMetricJoints));
  scene::Work work("metric", 40);  // shares as measured on a chain of 60 joints
  const auto model = recursive::buildModel(scene.mechanism, RunningErrorNumbers(scene.mechanism));
  std::vector<scene::JointPosition<Error>> x;
  for (const double value : q) x.push_back(runningErrorPosition(value));
  KineticMetric<Error> metric(model, x);
  const int n = metric.n();
  MetricAt out;
  out.M = split(metric.M());
  std::vector<MatrixOf<Error>> raised(n, MatrixOf<Error>(n, n));
  for (int i = 0; i < n; ++i) {
    MatrixOf<Error> first(n, n);
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) first(j, k) = metric.christoffel(i, j, k);
    out.first.push_back(split(first));
  }
  work.doneTo(0.05);
  std::optional<scene::Work> part(std::in_place, "Christoffel symbols of the second kind", n, 18);
  for (int j = 0; j < n; ++j, part->done())
    for (int k = 0; k < n; ++k) {
      KineticMetric<Error>::Vector column(n);
      for (int i = 0; i < n; ++i) column(i) = metric.christoffel(i, j, k);
      column = metric.raised(column);
      for (int i = 0; i < n; ++i) raised[i](j, k) = column(i);
    }
  for (const auto& matrix : raised) out.second.push_back(split(matrix));
  MatrixOf<Error> curvature = MatrixOf<Error>::Constant(n, n, Error(0));
  part.reset();
  part.emplace("curvature", n * (n - 1) / 2, 20);
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j, part->done())
      curvature(i, j) = curvature(j, i) = metric.sectional(metric.unit(i), metric.unit(j));
  out.sectional = split(curvature);
  return out;
}

}  // namespace dynwitness::crosscheck
