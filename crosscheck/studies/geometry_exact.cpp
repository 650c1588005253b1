// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of the kinetic metric as two sides, over the field.
#include "crosscheck/exact/inquiry.hpp"
#include "crosscheck/inputs/features.hpp"
#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/studies/kinetic_metric.hpp"
#include "crosscheck/verdicts/within_bounds.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"

namespace dynwitness::crosscheck {
namespace {

constexpr IdentityInfo kLaws[] = {
    {"Christoffel symbols give c", "Gamma_i,jk qd_j qd_k = c", "c", "metric", "newton_euler"},
    {"Christoffel symbols give C", "Gamma_i,jk qd_k = C_ij", "C", "metric", "composite_body"},
    {"geodesics are motion without forces", "qdd = -Gamma^i_jk qd_j qd_k", "qdd", "metric",
     "articulated_body"},
    {"curvature from inside is curvature from outside",
     "R(u,v,u,v) from M = <II(u,u), II(v,v)> - <II(u,v), II(u,v)>", "R", "metric",
     "recursive_lagrange"},
    {"Jacobi's equation", "D2J/dt2 = -R(J, qd) qd for neighbouring motions without forces", "J",
     "articulated_body", "metric"},
    {"Bianchi's identity", "R_ijkl + R_jkil + R_kijl = 0", "R", "metric", ""},
};

/// Both sides of each law; u, v, w are the state's qd, qdd and tau: arbitrary vectors.
template <typename Numbers, typename T = typename Numbers::Scalar>
std::vector<TwoSides<T>> laws(const scene::Mechanism& mechanism, const Numbers& number,
                              const scene::State<T>& state) {
  using D = Dual<T>;
  using Vector = recursive::VectorX<T>;
  std::vector<TwoSides<T>> out(std::size(kLaws));
  const auto one = [](const T& value) { return MatrixOf<T>(scalar(value)); };
  try {
    const recursive::Model<T> model = recursive::buildModel(mechanism, number);
    Setup<T> setup(model);
    KineticMetric<T> metric(model, state.x);
    const int n = metric.n();
    const Vector u = column(state.qd), v = column(state.qdd), w = column(state.tau);

    const Vector coriolis = metric.christoffel(u, u);
    out[0] = {coriolis, setup.inverse(state, state.qd, setup.zeros(), Terms::none())};

    MatrixOf<T> C(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        C(i, j) = T(0);
        for (int k = 0; k < n; ++k) C(i, j) += metric.christoffel(i, j, k) * u(k);
      }
    out[1] = {C, recursive::coriolisMatrix(model, state.x, state.qd, setup.ws)};

    const Vector qdd = -metric.raised(coriolis);
    std::vector<T> free = setup.zeros();
    recursive::forwardDynamics(model, state.x, state.qd, setup.zeros(), setup.ws, free,
                               Terms::none());
    out[2] = {qdd, column(free)};

    // Gauss: second fundamental forms, normal parts of d2x/dq_i dq_j in the space of all points
    HomogeneousModel<T> points(mechanism, number);
    const auto uu = points.secondPartials(state.x, state.qd, state.qd);
    const auto vv = points.secondPartials(state.x, state.qdd, state.qdd);
    const auto uv = points.secondPartials(state.x, state.qd, state.qdd);
    const Vector along_uu = column(points.weightedWithFirst(uu)),
                 along_vv = column(points.weightedWithFirst(vv)),
                 along_uv = column(points.weightedWithFirst(uv));
    MatrixOf<T> M = points.massMatrix(state.x);
    recursive::factorize(M);
    const auto tangential = [&](const Vector& a, Vector b) {
      recursive::solve(M, b);
      return T(a.dot(b));
    };
    out[3] = {one(metric.riemann(u, v, u, v)),
              one(points.weighted(uu, vv) - tangential(along_uu, along_vv) -
                  points.weighted(uv, uv) + tangential(along_uv, along_uv))};

    // Jacobi: J = v, dJ/dt = v w by components; d2J/dt2 differentiates the articulated bodies
    Vector J_rate(n);
    for (int i = 0; i < n; ++i) J_rate(i) = v(i) * w(i);
    const recursive::Model<D> moved = lifted<D>(model);
    std::vector<scene::JointPosition<D>> x_aside, x_now;
    std::vector<D> qd_aside, no_force(n, D(T(0))), qdd_aside(n, D(T(0)));
    recursive::VectorX<D> qd_now(n), J_now(n);
    for (int i = 0; i < n; ++i) {
      x_aside.push_back(moving(state.x[i], v(i)));
      x_now.push_back(moving(state.x[i], u(i)));
      qd_aside.push_back(D(u(i), J_rate(i)));
      qd_now(i) = D(u(i), qdd(i));
      J_now(i) = D(v(i), J_rate(i));
    }
    recursive::Workspace<D> ws(moved);
    recursive::forwardDynamics(moved, x_aside, qd_aside, no_force, ws, qdd_aside, Terms::none());
    // the covariant derivative dJ/dt + Gamma(qd, J), and that of it
    const KineticMetric<D> metric_now(moved, x_now);
    const recursive::VectorX<D> turning = metric_now.raised(metric_now.christoffel(qd_now, J_now));
    Vector DJ(n), D2J(n);
    for (int i = 0; i < n; ++i) DJ(i) = J_rate(i) + turning(i).value;
    const Vector turning_DJ = metric.raised(metric.christoffel(u, DJ));
    for (int i = 0; i < n; ++i)
      D2J(i) = qdd_aside[i].derivative + turning(i).derivative + turning_DJ(i);
    out[4] = {one(metric.product(w, D2J)), one(-metric.riemann(v, u, w, u))};

    out[5] = {one(metric.riemann(u, v, w, DJ) + metric.riemann(v, w, u, DJ) +
                  metric.riemann(w, u, v, DJ)),
              one(T(0))};
  } catch (const DivisionByZero& error) {
    for (TwoSides<T>& failed : out) failed = {{}, {}, error.what()};
  }
  return out;
}

}  // namespace

std::vector<CheckResult> checkGeometryExactly(const scene::Scene& scene,
                                              const ExactOptions& options) {
  requireTreated(scene, Command::kGeometry);
  Inquiry inquiry;
  inquiry.checks = inWords(kLaws);
  const auto ask = [&](const auto& number, const auto& state) {
    return laws(scene.mechanism, number, state);
  };
  inquiry.in_field = ask;
  inquiry.in_degrees = ask;
  return decide(scene, inquiry, options);
}

}  // namespace dynwitness::crosscheck
