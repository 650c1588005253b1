// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of the kinetic metric.
#pragma once

#include <numeric>
#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/studies/closure_forces.hpp"
#include "crosscheck/studies/kinetic_metric.hpp"
#include "crosscheck/witnesses/recursive_lagrange.hpp"
#include "crosscheck/witnesses/sweep_algorithms.hpp"
#include "recursive/closed_dynamics.hpp"

namespace dynwitness::crosscheck {

/// A model that nothing pulls at: no gravity, springs, friction and loads.
template <typename T>
recursive::Model<T> withoutForces(recursive::Model<T> model) {
  model.gravity = recursive::Vector3<T>::Constant(T(0));
  model.friction = false;
  model.world_loads.clear();
  for (recursive::LinkModel<T>& link : model.links) {
    link.viscous = link.positive = link.negative = link.stiffness = T(0);
    link.load = recursive::Force<T>::zero();
  }
  return model;
}

/// qdd of a motion without forces, by the articulated bodies; loops eliminated where they close.
template <typename T>
recursive::VectorX<T> freeAccelerations(const recursive::Model<T>& without_forces,
                                        recursive::Constraints<T>& closures,
                                        const std::vector<scene::JointPosition<T>>& x,
                                        const std::vector<T>& qd) {
  recursive::Workspace<T> ws(without_forces);
  const std::vector<T> none(qd.size(), T(0));
  if (closures.closures.empty()) {
    std::vector<T> qdd = none;
    recursive::forwardDynamics(without_forces, x, qd, none, ws, qdd, Terms::none());
    return column(qdd);
  }
  recursive::constraintEquations(without_forces, x, qd, ws, closures);
  return column(recursive::closedForwardDynamics(without_forces, x, qd, none, closures, ws).qdd);
}

/** A mechanism at a state, and its mass matrix as a metric there. u, v, w are the state's qd, qdd
    and tau, on closed mechanisms the nearest vectors along the surface on which the closures keep
    the values that they have at this state, which need not be 0: any three vectors. The state must
    outlive it. */
template <typename T>
class MetricAsked {
 public:
  using Scalar = T;
  using Vector = recursive::VectorX<T>;

  template <typename Numbers>
  MetricAsked(const scene::Mechanism& mechanism, const Numbers& number,
              const scene::State<T>& state)
      : state(state),
        sweeps(recursive::buildModel(mechanism, number)),
        closures(recursive::buildConstraints(mechanism, number, sweeps.model)),
        metric(sweeps.model, state.x, closures, allRows(closures)),
        u(metric.tangent(column(state.qd))),
        v(metric.tangent(column(state.qdd))),
        w(metric.tangent(column(state.tau))),
        points(mechanism, number) {}

  /// The motion without forces.
  const Vector& geodesic() {
    return geodesic_([&] { return Vector(-metric.connection(u, u)); });
  }
  /// A motion without forces that starts aside by J = v and with a rate of J that w gives: where
  /// nothing is closed the sum of v_i w_i e_i.
  struct Neighbour {
    Vector DJ, D2J;  ///< covariant derivatives along the motion
  };
  const Neighbour& neighbour() {
    return neighbour_([&] {
      using D = Dual<T>;
      const int n = metric.n();
      const RateFrame& frame = metric.frame();
      const Vector& qdd = geodesic();
      // the rates of the motion aside change by dJ/dt + [qd, J], so that it stays on the surface
      Vector aside(n);
      for (int i = 0; i < n; ++i) aside(i) = v(i) * w(i);
      aside += frame.commutator(u, v);
      aside = metric.tangent(aside) + metric.byClosures(v, u);
      const Vector J_rate = aside - frame.commutator(u, v);
      const auto x_aside = movedAlong(sweeps.model, state.x, v),
                 x_now = movedAlong(sweeps.model, state.x, u);
      std::vector<D> qd_aside;
      recursive::VectorX<D> qd_now(n), J_now(n);
      for (int i = 0; i < n; ++i) {
        qd_aside.push_back(D(u(i), aside(i)));
        qd_now(i) = D(u(i), qdd(i));
        J_now(i) = D(v(i), J_rate(i));
      }
      // d2J/dt2 differentiates the articulated bodies
      const recursive::Model<D> model = lifted<D>(sweeps.model);
      auto closures_aside = lifted<D>(closures, n);
      const recursive::VectorX<D> qdd_aside =
          freeAccelerations(withoutForces(model), closures_aside, x_aside, qd_aside);
      // the covariant derivative dJ/dt + Gamma(qd, J), and that of it
      KineticMetric<D> metric_now(model, x_now, closures_aside, allRows(closures));
      const recursive::VectorX<D> turning = metric_now.connection(qd_now, J_now);
      Neighbour out = {Vector(n), Vector(n)};
      for (int i = 0; i < n; ++i) out.DJ(i) = J_rate(i) + turning(i).value;
      out.D2J =
          metric.connection(u, out.DJ) + frame.commutator(J_rate, u) + frame.commutator(v, qdd);
      for (int i = 0; i < n; ++i) out.D2J(i) += qdd_aside(i).derivative + turning(i).derivative;
      return out;
    });
  }
  static MatrixX<T> one(const T& value) { return MatrixX<T>(scalar(value)); }

  const scene::State<T>& state;
  Setup<T> sweeps;
  recursive::Constraints<T> closures;
  KineticMetric<T> metric;
  Vector u, v, w;
  HomogeneousModel<T> points;

 private:
  static std::vector<int> allRows(const recursive::Constraints<T>& closures) {
    std::vector<int> rows(static_cast<std::size_t>(closures.rows()));
    std::iota(rows.begin(), rows.end(), 0);
    return rows;
  }

  Kept<Vector> geodesic_;
  Kept<Neighbour> neighbour_;
};

/// What is said of a tree alone.
struct TreeLaw : Law {
  static bool appliesTo(const scene::Mechanism& mechanism) { return mechanism.closures.empty(); }
};

struct ChristoffelSymbolsGivec : TreeLaw {
  static constexpr LawWords kWords = {"Christoffel symbols give c", "Gamma_i,jk qd_j qd_k = c", "c",
                                      "metric", "newton_euler"};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    return {at.metric.christoffel(at.u, at.u),
            at.sweeps.inverse(at.state, at.state.qd, at.sweeps.zeros(), Terms::none())};
  }
};

struct ChristoffelSymbolsGiveC : TreeLaw {
  static constexpr LawWords kWords = {"Christoffel symbols give C", "Gamma_i,jk qd_j = C_ik", "C",
                                      "metric", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    const int n = at.metric.n();
    MatrixX<T> C(n, n);
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k) {
        C(i, k) = T(0);
        for (int j = 0; j < n; ++j) C(i, k) += at.metric.christoffel(i, j, k) * at.u(j);
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
    const std::vector<T> qd(at.u.data(), at.u.data() + at.u.size());
    return {at.geodesic(),
            freeAccelerations(withoutForces(at.sweeps.model), at.closures, at.state.x, qd)};
  }
};

/** Gauss: second fundamental forms, normal parts of d2x/dq_i dq_j in the space of all points; on
    closed mechanisms of x along the surface, phi differentiated twice as it stands. */
struct CurvatureFromOutside : Law {
  static constexpr LawWords kWords = {"curvature from inside is curvature from outside",
                                      "R(u,v,u,v) from M = <II(u,u), II(v,v)> - <II(u,v), II(u,v)>",
                                      "R", "metric", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(MetricAsked<T>& at) {
    using Vector = recursive::VectorX<T>;
    const std::vector<scene::JointPosition<T>>& x = at.state.x;
    const MatrixX<T> metric = at.points.massMatrix(x);
    MatrixX<T> M = metric;
    recursive::factorize(M);
    const PhiDerivatives<T> phi(at);
    const int m = at.closures.rows();
    const MatrixX<T> by_force = byClosureForces(M, phi.J);
    MatrixX<T> N = phi.J * by_force;
    recursive::factorize(N);
    struct Bend {
      std::vector<Matrix4<T>> second;  ///< d2x/dq_i dq_j u_i v_j
      Vector along, a;  ///< of it along dx/dq_k; with dx/dq_k a_k added it is normal to the surface
    };
    const auto bend = [&](const Vector& u, const Vector& v) {
      Bend out;
      out.second = at.points.secondPartials(x, entries(u), entries(v));
      out.along = column(at.points.weightedWithFirst(out.second));
      out.a = -out.along;
      recursive::solve(M, out.a);
      if (m == 0) return out;
      Vector lambda = phi.second(u, v) + phi.J * out.a;
      recursive::solve(N, lambda);
      out.a -= by_force * lambda;
      return out;
    };
    const Vector &u = at.u, &v = at.v;
    const Bend uu = bend(u, u), vv = bend(v, v), uv = bend(u, v);
    const auto product = [&](const Bend& p, const Bend& q) {
      return T(at.points.weighted(p.second, q.second) + p.a.dot(q.along) + q.a.dot(p.along) +
               p.a.dot(Vector(metric * q.a)));
    };
    return {at.one(at.metric.riemann(u, v, u, v)), at.one(product(uu, vv) - product(uv, uv))};
  }

 private:
  template <typename T>
  static std::vector<T> entries(const recursive::VectorX<T>& v) {
    return {v.data(), v.data() + v.size()};
  }
  /// dphi and d2phi, by differentiating phi: no Jacobian of the sweeps.
  template <typename T>
  struct PhiDerivatives {
    using D = Dual<T>;
    using DD = Dual<D>;
    explicit PhiDerivatives(MetricAsked<T>& at)
        : at(at),
          once(lifted<D>(at.sweeps.model)),
          twice(lifted<DD>(at.sweeps.model)),
          J(at.closures.rows(), at.metric.n()) {
      if (J.rows() == 0) return;
      auto closures = lifted<D>(at.closures, at.metric.n());
      recursive::Workspace<D> ws(once);
      for (int j = 0; j < at.metric.n(); ++j) {
        const auto x = movedAlong(at.sweeps.model, at.state.x, at.metric.unit(j));
        recursive::constraintEquations(once, x, std::vector<D>(at.metric.n(), D(T(0))), ws,
                                       closures);
        for (Eigen::Index k = 0; k < J.rows(); ++k) J(k, j) = closures.phi(k).derivative;
      }
    }
    /// u(v(phi)), components constant.
    recursive::VectorX<T> second(const recursive::VectorX<T>& u,
                                 const recursive::VectorX<T>& v) const {
      const int n = at.metric.n();
      recursive::VectorX<D> later(n);
      for (int i = 0; i < n; ++i) later(i) = D(v(i));
      auto closures = lifted<DD>(at.closures, n);
      recursive::Workspace<DD> ws(twice);
      recursive::constraintEquations(
          twice, movedAlong(once, movedAlong(at.sweeps.model, at.state.x, u), later),
          std::vector<DD>(n, DD(D(T(0)))), ws, closures);
      recursive::VectorX<T> out(J.rows());
      for (Eigen::Index k = 0; k < J.rows(); ++k) out(k) = closures.phi(k).derivative.derivative;
      return out;
    }
    MetricAsked<T>& at;
    recursive::Model<D> once;
    recursive::Model<DD> twice;
    MatrixX<T> J;
  };
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
