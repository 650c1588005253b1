// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/geometry.hpp"

#include <fmt/format.h>

#include "crosscheck/studies/kinetic_metric.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "recursive/build_model.hpp"

namespace dynwitness::crosscheck {

void requireOpenTree(const scene::Scene& scene) {
  const scene::SourceLocation file{scene.file.string(), 0};
  if (!scene.mechanism.isOpenTree())
    throw scene::InputError(file,
                            "has closures, or springs between points, allowed: a tree of links");
  if (scene.mechanism.dof() == 0) throw scene::InputError(file, "has no joint that moves");
}

void requireCoordinates(const scene::Scene& scene) {
  requireOpenTree(scene);
  for (const scene::Link& link : scene.mechanism.links)
    if (!scene::ratesArePositionDerivatives(link.joint.kind))
      throw scene::InputError(
          link.where, fmt::format("joint '{}' is {}: its rates are no derivatives of coordinates, "
                                  "allowed: joints whose q are coordinates",
                                  link.joint.name, scene::name(link.joint.kind)));
}

namespace {

using Error = RunningError;

Bounded split(const MatrixOf<Error>& m) {
  return {m.unaryExpr([](const Error& e) { return e.value(); }),
          m.unaryExpr([](const Error& e) { return e.bound(); })};
}

}  // namespace

MetricAt metricAt(const scene::Scene& scene, const std::vector<double>& q) {
  requireCoordinates(scene);
  if (static_cast<int>(q.size()) != scene.mechanism.dof())
    throw scene::InputError(
        {}, fmt::format("q: {} values, allowed: {}", q.size(), scene.mechanism.dof()));
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
  for (int j = 0; j < n; ++j)
    for (int k = 0; k < n; ++k) {
      KineticMetric<Error>::Vector column(n);
      for (int i = 0; i < n; ++i) column(i) = metric.christoffel(i, j, k);
      column = metric.raised(column);
      for (int i = 0; i < n; ++i) raised[i](j, k) = column(i);
    }
  for (const auto& matrix : raised) out.second.push_back(split(matrix));
  MatrixOf<Error> curvature = MatrixOf<Error>::Constant(n, n, Error(0));
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      curvature(i, j) = curvature(j, i) = metric.sectional(metric.unit(i), metric.unit(j));
  out.sectional = split(curvature);
  return out;
}

}  // namespace dynwitness::crosscheck
