// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of the kinetic metric.
#pragma once

#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/studies/kinetic_metric.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"

namespace dynwitness::crosscheck {

/// A mechanism at a state, and its mass matrix as a metric there. u, v, w are the state's qd, qdd
/// and tau: any three vectors. The state must outlive it.
template <typename T>
class MetricAsked {
 public:
  using Scalar = T;
  using Vector = recursive::VectorX<T>;

  template <typename Numbers>
  MetricAsked(const scene::Mechanism& mechanism, const Numbers& number,
              const scene::State<T>& state)
      : state(state),
        u(column(state.qd)),
        v(column(state.qdd)),
        w(column(state.tau)),
        sweeps(recursive::buildModel(mechanism, number)),
        metric(sweeps.model, state.x),
        points(mechanism, number) {}

  /// The motion without forces.
  const Vector& geodesic() {
    return geodesic_([&] { return Vector(-metric.raised(metric.christoffel(u, u))); });
  }
  /// A motion without forces that starts aside by J = v and with J's rate, entry by entry, v w.
  struct Neighbour {
    Vector DJ, D2J;  ///< covariant derivatives along the motion
  };
  const Neighbour& neighbour() {
    return neighbour_([&] {
      using D = Dual<T>;
      const int n = metric.n();
      const Vector& qdd = geodesic();
      Vector J_rate(n);
      for (int i = 0; i < n; ++i) J_rate(i) = v(i) * w(i);
      // d2J/dt2 differentiates the articulated bodies
      const recursive::Model<D> moved = lifted<D>(sweeps.model);
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
      const recursive::VectorX<D> turning =
          metric_now.raised(metric_now.christoffel(qd_now, J_now));
      Neighbour out = {Vector(n), Vector(n)};
      for (int i = 0; i < n; ++i) out.DJ(i) = J_rate(i) + turning(i).value;
      const Vector turning_DJ = metric.raised(metric.christoffel(u, out.DJ));
      for (int i = 0; i < n; ++i)
        out.D2J(i) = qdd_aside[i].derivative + turning(i).derivative + turning_DJ(i);
      return out;
    });
  }
  static MatrixOf<T> one(const T& value) { return MatrixOf<T>(scalar(value)); }

  const scene::State<T>& state;
  Vector u, v, w;
  Setup<T> sweeps;
  KineticMetric<T> metric;
  HomogeneousModel<T> points;

 private:
  Kept<Vector> geodesic_;
  Kept<Neighbour> neighbour_;
};

struct ChristoffelSymbolsGivec : Law {
  static constexpr LawWords kWords = {"Christoffel symbols give c", "Gamma_i,jk qd_j qd_k = c", "c",
                                      "metric", "newton_euler"};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    return {at.metric.christoffel(at.u, at.u),
            at.sweeps.inverse(at.state, at.state.qd, at.sweeps.zeros(), Terms::none())};
  }
};

struct ChristoffelSymbolsGiveC : Law {
  static constexpr LawWords kWords = {"Christoffel symbols give C", "Gamma_i,jk qd_k = C_ij", "C",
                                      "metric", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    const int n = at.metric.n();
    MatrixOf<T> C(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        C(i, j) = T(0);
        for (int k = 0; k < n; ++k) C(i, j) += at.metric.christoffel(i, j, k) * at.u(k);
      }
    return {C, recursive::coriolisMatrix(at.sweeps.model, at.state.x, at.state.qd, at.sweeps.ws)};
  }
};

struct GeodesicsAreMotion : Law {
  static constexpr LawWords kWords = {"geodesics are motion without forces",
                                      "qdd = -Gamma^i_jk qd_j qd_k", "qdd", "metric",
                                      "articulated_body"};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    std::vector<T> free = at.sweeps.zeros();
    recursive::forwardDynamics(at.sweeps.model, at.state.x, at.state.qd, at.sweeps.zeros(),
                               at.sweeps.ws, free, Terms::none());
    return {at.geodesic(), column(free)};
  }
};

/// Gauss: second fundamental forms, normal parts of d2x/dq_i dq_j in the space of all points.
struct CurvatureFromOutside : Law {
  static constexpr LawWords kWords = {"curvature from inside is curvature from outside",
                                      "R(u,v,u,v) from M = <II(u,u), II(v,v)> - <II(u,v), II(u,v)>",
                                      "R", "metric", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    using Vector = recursive::VectorX<T>;
    const scene::State<T>& state = at.state;
    const auto uu = at.points.secondPartials(state.x, state.qd, state.qd);
    const auto vv = at.points.secondPartials(state.x, state.qdd, state.qdd);
    const auto uv = at.points.secondPartials(state.x, state.qd, state.qdd);
    const Vector along_uu = column(at.points.weightedWithFirst(uu)),
                 along_vv = column(at.points.weightedWithFirst(vv)),
                 along_uv = column(at.points.weightedWithFirst(uv));
    MatrixOf<T> M = at.points.massMatrix(state.x);
    recursive::factorize(M);
    const auto tangential = [&](const Vector& a, Vector b) {
      recursive::solve(M, b);
      return T(a.dot(b));
    };
    return {at.one(at.metric.riemann(at.u, at.v, at.u, at.v)),
            at.one(at.points.weighted(uu, vv) - tangential(along_uu, along_vv) -
                   at.points.weighted(uv, uv) + tangential(along_uv, along_uv))};
  }
};

struct JacobiEquation : Law {
  static constexpr LawWords kWords = {"Jacobi's equation",
                                      "D2J/dt2 = -R(J, qd) qd for neighbouring motions without "
                                      "forces",
                                      "J", "articulated_body", "metric"};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    return {at.one(at.metric.product(at.w, at.neighbour().D2J)),
            at.one(-at.metric.riemann(at.v, at.u, at.w, at.u))};
  }
};

struct BianchiIdentity : Law {
  static constexpr LawWords kWords = {"Bianchi's identity", "R_ijkl + R_jkil + R_kijl = 0", "R",
                                      "metric", ""};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    const recursive::VectorX<T>&u = at.u, &v = at.v, &w = at.w;
    const recursive::VectorX<T>& fourth = at.neighbour().DJ;  // any will do
    return {at.one(at.metric.riemann(u, v, w, fourth) + at.metric.riemann(v, w, u, fourth) +
                   at.metric.riemann(w, u, v, fourth)),
            at.one(T(0))};
  }
};

using GeometryLaws = Laws<ChristoffelSymbolsGivec, ChristoffelSymbolsGiveC, GeodesicsAreMotion,
                          CurvatureFromOutside, JacobiEquation, BianchiIdentity>;

}  // namespace dynwitness::crosscheck
