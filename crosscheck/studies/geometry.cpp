// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/studies/geometry.hpp"

#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/inputs/features.hpp"
#include "crosscheck/motion/closed_motion.hpp"
#include "crosscheck/studies/constrained_linearization.hpp"
#include "crosscheck/studies/independent_rates.hpp"
#include "crosscheck/studies/kinetic_metric.hpp"
#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "scene/work.hpp"

namespace dynwitness::crosscheck {

namespace {

using Error = RunningError;

/// Two kinds of Christoffel symbols with their bounds take 32 n^3 bytes: 0.5 GB.
constexpr int kMostMetricJoints = 256;

Bounded split(const MatrixX<Error>& m) {
  return {m.unaryExpr([](const Error& e) { return e.value(); }),
          m.unaryExpr([](const Error& e) { return e.bound(); })};
}

/// The frame of the independent rates.
struct Frame {
  Frame(KineticMetric<Error> of, const Surface& surface)
      : metric(std::move(of)), rates(surface.rates), is_closed(!surface.rows.empty()) {
    const auto n = static_cast<Eigen::Index>(metric.n()),
               f = static_cast<Eigen::Index>(rates.size());
    along = MatrixX<Error>::Constant(n, f, Error(0));
    for (Eigen::Index a = 0; a < f; ++a) along(rates[static_cast<std::size_t>(a)], a) = Error(1);
    if (!is_closed) return;
    const MatrixX<Error> D = metric.J()(Eigen::all, surface.dependent);
    along(surface.dependent, Eigen::all) = -solved<Error>(D, metric.J()(Eigen::all, surface.rates));
    for (Eigen::Index b = 0; b < f; ++b)
      for (Eigen::Index c = 0; c < f; ++c) {
        // E_b(E_c): of the dependent rates alone, so that J E_c stays 0
        recursive::VectorX<Error> turned = recursive::VectorX<Error>::Constant(n, Error(0));
        turned(surface.dependent) =
            -solved<Error>(D, metric.closureSecond(along.col(b), along.col(c)));
        derived.push_back(along.transpose() *
                          (metric.M() * turned + metric.christoffel(along.col(b), along.col(c))));
      }
  }
  MatrixX<Error> massMatrix() const {
    if (!is_closed) return metric.M();
    return along.transpose() * (metric.M() * along);
  }
  /// <E_a, D_b E_c>
  Error first(int a, int b, int c) const {
    if (!is_closed) return metric.christoffel(a, b, c);
    return derived[static_cast<std::size_t>(b) * rates.size() + static_cast<std::size_t>(c)](a);
  }

  KineticMetric<Error> metric;
  std::vector<int> rates;
  bool is_closed;
  MatrixX<Error> along;  ///< E_a, n x f
  std::vector<recursive::VectorX<Error>>
      derived;  ///< of closed mechanisms <E_a, D_b E_c>, by b and c
};

}  // namespace

Surface surfaceNear(const scene::Scene& scene, const std::vector<double>& q,
                    const std::vector<double>& qd) {
  requireMotion(scene);
  if (static_cast<int>(q.size()) != scene.mechanism.positions())
    throw scene::InputError(
        {}, fmt::format("q: {} values, allowed: {}", q.size(), scene.mechanism.positions()));
  Surface out;
  out.q = q;
  Indices all(static_cast<std::size_t>(scene.mechanism.dof()));
  std::iota(all.begin(), all.end(), 0);
  out.rates = all;
  out.qd = qd.empty() ? std::vector<double>(all.size(), 0.0) : qd;
  if (scene.mechanism.closures.empty()) return out;
  ConstrainedLinearization(scene).close(&out.q, &out.qd);
  ClosedMotion motion(scene, 0);
  ClosedMotion::State y = out.q;
  y.resize(out.q.size() + all.size() + 1, 0.0);
  motion.choose(y, 0);
  out.rows = motion.chosen();
  out.has_dependent_rows = static_cast<int>(out.rows.size()) < motion.rows();
  out.dependent = pivots(motion.jacobian()(out.rows, Eigen::all), all);
  out.rates = without(all, out.dependent);
  return out;
}

MetricAt metricAt(const scene::Scene& scene, const std::vector<double>& q) {
  requireTreated(scene, Command::kGeometry);
  MetricAt out;
  out.surface = surfaceNear(scene, q);
  const int n = scene.mechanism.dof(), f = static_cast<int>(out.surface.rates.size());
  if (n > kMostMetricJoints)
    throw scene::InputError(
        {scene.file.string()},
        fmt::format("has {0} joints and {0}^3 Christoffel symbols of each kind, raised by {0}^4 "
                    "operations; allowed: {1} joints",
                    n, kMostMetricJoints));
  scene::Work work("metric", 40);  // shares as measured on a chain of 60 joints
  const RunningErrorNumbers number(scene.mechanism);
  const auto model = recursive::buildModel(scene.mechanism, number);
  std::vector<scene::JointPosition<Error>> x;
  for (const double value : out.surface.q) x.push_back(runningErrorPosition(value));
  Frame frame{
      KineticMetric<Error>(model, x, recursive::buildConstraints(scene.mechanism, number, model),
                           out.surface.rows),
      out.surface};
  out.commutes = frame.metric.frame().commutes();
  const MatrixX<Error> M = frame.massMatrix();
  MatrixX<Error> LDL = M;
  recursive::factorize(LDL);
  out.M = split(M);
  for (int a = 0; a < f; ++a) {
    MatrixX<Error> first(f, f);
    for (int b = 0; b < f; ++b)
      for (int c = 0; c < f; ++c) first(b, c) = frame.first(a, b, c);
    out.first.push_back(split(first));
  }
  work.doneTo(0.05);
  std::vector<MatrixX<Error>> raised(f, MatrixX<Error>(f, f));
  std::optional<scene::Work> part(std::in_place, "Christoffel symbols of the second kind", f, 18);
  for (int b = 0; b < f; ++b, part->done())
    for (int c = 0; c < f; ++c) {
      recursive::VectorX<Error> column(f);
      for (int a = 0; a < f; ++a) column(a) = frame.first(a, b, c);
      recursive::solve(LDL, column);
      for (int a = 0; a < f; ++a) raised[a](b, c) = column(a);
    }
  for (const auto& matrix : raised) out.second.push_back(split(matrix));
  MatrixX<Error> curvature = MatrixX<Error>::Constant(f, f, Error(0));
  part.reset();
  part.emplace("curvature", f * (f - 1) / 2, 20);
  for (int a = 0; a < f; ++a)
    for (int b = a + 1; b < f; ++b, part->done())
      curvature(a, b) = curvature(b, a) =
          frame.metric.sectional(frame.along.col(a), frame.along.col(b));
  out.sectional = split(curvature);
  return out;
}

}  // namespace dynwitness::crosscheck
