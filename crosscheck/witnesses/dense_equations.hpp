// SPDX-License-Identifier: GPL-3.0-or-later
// Lagrange's equations of a whole mechanism with multipliers, as one dense system: made by
// derivation or by sweeps, solved the same way, on any scalar.
#pragma once

#include <algorithm>
#include <vector>

#include "crosscheck/witnesses/bounded_answer.hpp"
#include "recursive/acceleration_constraints.hpp"
#include "recursive/constraints.hpp"
#include "recursive/factorization.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/operational_space.hpp"
#include "recursive/point_springs.hpp"
#include "symbolic/closures.hpp"
#include "symbolic/equations.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck {

template <typename T>
using VectorOf = Eigen::Matrix<T, Eigen::Dynamic, 1>;

namespace detail {

/// Twelve numbers a frame (symbolic::frameEquations): where they are, and how they move.
template <typename T>
struct Frames {
  MatrixOf<T> place, J, gamma;
};

}  // namespace detail

/** What must hold at a state, rows of closures first, then those of acceleration constraints:

        M qdd + bias = tau + J' nu,      J qdd + C nu = b

    bias = c + g + friction - Q, springs between points in it; C diagonal; qdd of driven joints is
    given, and their tau wanted. */
template <typename T>
struct DenseEquations {
  MatrixOf<T> M, J;          ///< n x n, m x n
  VectorOf<T> bias, b;       ///< n [N m, N]; m [m/s^2, 1/s^2]
  VectorOf<T> C;             ///< m [1/kg]
  detail::Frames<T> frames;  ///< by derivation: of acceleration constraints, then of springs' ends
};

// ---- by derivation ------------------------------------------------------------------------------

/// The equations from T, V and the places of frames in the world, as a program.
struct DerivedConstraints {
  /// @param with_springs  whether the ends of springs between points are asked for
  DerivedConstraints(const scene::Mechanism& mechanism, bool fold_parameters, bool with_springs);
  symbolic::Program program;
  int n = 0, closure_rows = 0, frames = 0;
};

namespace detail {

/// Reads numbers off one after the other.
template <typename T>
MatrixOf<T> take(const T*& from, Eigen::Index rows, Eigen::Index columns) {
  MatrixOf<T> m(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < columns; ++j) m(i, j) = *from++;
  return m;
}

/** How the distance of a spring's ends depends on the motion. With d = x_b - x_a:
        l2 = d . d,      along = (J_b - J_a)' d,      so that  l l' = along . qd
    and a pull  p d  on a, -p d on b does the work of  tau = -along p. */
template <typename T>
struct SpringGeometry {
  SpringGeometry(const Frames<T>& frames, Eigen::Index spring_end)
      : along(VectorOf<T>::Constant(frames.J.cols(), T(0))) {
    const Eigen::Index a = 12 * spring_end, b = a + 12;
    for (int k = 0; k < 3; ++k) {
      const T d = frames.place(b + k, 0) - frames.place(a + k, 0);
      l2 += d * d;
      for (Eigen::Index j = 0; j < along.size(); ++j)
        along(j) += (frames.J(b + k, j) - frames.J(a + k, j)) * d;
    }
  }
  T l2 = T(0);
  VectorOf<T> along;
};

/// What springs between points take off the right side: -tau, for a pull  pull(spring, l2, l l') d.
template <typename Numbers, typename T, typename Pull>
VectorOf<T> againstSprings(const Frames<T>& frames, Eigen::Index first,
                           const scene::Mechanism& mechanism, const Numbers&,
                           const std::vector<T>& qd, const Pull& pull) {
  VectorOf<T> out = VectorOf<T>::Constant(static_cast<Eigen::Index>(qd.size()), T(0));
  for (const scene::Spring& spring : mechanism.springs) {
    const SpringGeometry<T> at(frames, first);
    first += 2;
    T l_l_rate = T(0);
    for (std::size_t j = 0; j < qd.size(); ++j)
      l_l_rate += at.along(static_cast<Eigen::Index>(j)) * qd[j];
    out += at.along * T(pull(spring, at.l2, l_l_rate));
  }
  return out;
}

}  // namespace detail

/// @tparam kSprings  they ask for a square root, which a field need not have
template <bool kSprings, typename Numbers, typename T = typename Numbers::Scalar>
DenseEquations<T> derivedEquations(const DerivedConstraints& derived,
                                   const scene::Mechanism& mechanism, const Numbers& number,
                                   const scene::State<T>& state) {
  const std::vector<T> values = symbolic::ProgramRun<T>(derived.program, number)(state);
  const T* from = values.data();
  const int n = derived.n, m = derived.closure_rows;
  const auto& held = mechanism.acceleration_constraints;
  const int k = static_cast<int>(held.size());
  DenseEquations<T> out;
  out.M = detail::take(from, n, n);
  const VectorOf<T> c = detail::take(from, n, 1), g = detail::take(from, n, 1),
                    Q = detail::take(from, n, 1);
  out.bias = c + g - Q;
  out.J = MatrixOf<T>::Constant(m + k, n, T(0));
  out.b = out.C = VectorOf<T>::Constant(m + k, T(0));
  detail::take(from, m, 1);  // phi
  out.J.topRows(m) = detail::take(from, m, n);
  out.b.head(m) = detail::take(from, m, 1) * T(-1);
  detail::Frames<T> frames;
  frames.place = detail::take(from, 12 * derived.frames, 1);
  frames.J = detail::take(from, 12 * derived.frames, n);
  frames.gamma = detail::take(from, 12 * derived.frames, 1);
  using V3 = Eigen::Matrix<T, 3, 1>;
  const auto numbers = [&number](const scene::Vector& v) {
    return V3(number(v[0]), number(v[1]), number(v[2]));
  };
  for (int i = 0; i < k; ++i) {
    V3 u = numbers(held[i].direction), d = numbers(held[i].rotation);
    const auto axis = [&](int a) {
      return V3(frames.place.col(0).template segment<3>(12 * i + 3 + 3 * a));
    };
    if (held[i].axes == scene::AccelerationConstraint::Axes::kLink) {
      u = (axis(0) * u(0) + axis(1) * u(1) + axis(2) * u(2)).eval();
      d = (axis(0) * d(0) + axis(1) * d(1) + axis(2) * d(2)).eval();
    }
    // u . x'' + d . w',  w' = sum of e_a x e_a'' / 2
    const auto seen = [&](const auto& column) {
      T sum = u.dot(V3(column.template segment<3>(12 * i)));
      for (int a = 0; a < 3; ++a)
        sum += d.dot(axis(a).cross(V3(column.template segment<3>(12 * i + 3 + 3 * a)))) / T(2);
      return sum;
    };
    for (int j = 0; j < n; ++j) out.J(m + i, j) = seen(frames.J.col(j));
    out.b(m + i) = number(held[i].value) - seen(frames.gamma.col(0));
    out.C(m + i) = number(held[i].compliance);
  }
  if constexpr (kSprings)
    out.bias += detail::againstSprings(
        frames, k, mechanism, number, state.qd,
        [&number](const scene::Spring& spring, const T& l2, const T& l_l_rate) {
          using std::sqrt;
          const T l = sqrt(l2);
          return T((number(spring.stiffness) * (l - number(spring.rest)) +
                    number(spring.damping) * (l_l_rate / l)) /
                   l);
        });
  out.frames = frames;
  return out;
}

// ---- by sweeps ----------------------------------------------------------------------------------

/// M by composite bodies, bias by Newton and Euler, J and b by outward sweeps.
template <typename Numbers, typename T = typename Numbers::Scalar>
DenseEquations<T> sweptEquations(const scene::Mechanism& mechanism, const Numbers& number,
                                 const scene::State<T>& state) {
  const auto model = recursive::buildModel(mechanism, number);
  recursive::Workspace<T> ws(model);
  auto closures = recursive::buildConstraints(mechanism, number, model);
  const auto springs = recursive::buildPointSprings(mechanism, number, model);
  const int n = model.dof(), m = closures.rows();
  DenseEquations<T> out;
  recursive::constraintEquations(model, state.x, state.qd, ws, closures);
  std::vector<T> pull(n, T(0)), bias(n, T(0));
  const std::vector<T> zero(n, T(0));
  recursive::addSpringForces(model, springs, closures.X_W, ws, pull);
  const auto held =
      recursive::accelerationConstraints(mechanism, number, model, state.x, state.qd, ws);
  const int k = static_cast<int>(held.size());
  recursive::MatrixX<T> J_held(k, n);
  if (k > 0) recursive::taskJacobian(model, held, ws, J_held);
  out.J = MatrixOf<T>::Constant(m + k, n, T(0));
  out.b = out.C = VectorOf<T>::Constant(m + k, T(0));
  out.J.topRows(m) = closures.J;
  out.J.bottomRows(k) = J_held;
  out.b.head(m) = closures.gamma * T(-1);
  // A' a at qdd = 0 and without gravity is (dJ/dt) qd
  recursive::inverseDynamics(model, state.x, state.qd, zero, ws, bias, recursive::Terms::none());
  for (int i = 0; i < k; ++i) {
    const recursive::Vector6<T> a = ws.a[held[i].link].vector(), A = held[i].A.col(0);
    out.b(m + i) = held[i].b(0) - A.dot(a);
    out.C(m + i) = held[i].compliance(0);
  }
  recursive::inverseDynamics(model, state.x, state.qd, zero, ws, bias);
  out.bias = column(bias) - column(pull);
  out.M = MatrixOf<T>(n, n);
  recursive::massMatrix(model, state.x, ws, out.M);
  return out;
}

// ---- solved -------------------------------------------------------------------------------------

template <typename T>
struct DenseSolution {
  VectorOf<T> qdd, nu, tau;  ///< n, m, n
};

/// Only these rows are asked.
template <typename T>
void keepRows(const std::vector<int>& rows, DenseEquations<T>& e) {
  const Eigen::Index m = static_cast<Eigen::Index>(rows.size());
  DenseEquations<T> kept = e;
  kept.J.resize(m, e.J.cols());
  kept.b.resize(m);
  kept.C.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    kept.J.row(i) = e.J.row(rows[static_cast<std::size_t>(i)]);
    kept.b(i) = e.b(rows[static_cast<std::size_t>(i)]);
    kept.C(i) = e.C(rows[static_cast<std::size_t>(i)]);
  }
  e = kept;
}

/** One symmetric system in all unknowns, [M J'; J -C] (qdd, -nu) = (tau - bias, b), driven joints'
    columns on the right; then the forces of the driven joints from their rows. By L D L': M is
    positive definite and what is left of it, -(J M^-1 J' + C), negative, where rows of J are
    independent. */
template <typename T>
DenseSolution<T> solveDense(const DenseEquations<T>& e, const std::vector<char>& driven,
                            const std::vector<T>& tau, const std::vector<T>& qdd) {
  const int n = static_cast<int>(e.M.rows()), m = static_cast<int>(e.J.rows());
  std::vector<int> free;
  DenseSolution<T> out{VectorOf<T>::Constant(n, T(0)), VectorOf<T>(m), VectorOf<T>(n)};
  for (int i = 0; i < n; ++i) {
    if (driven[i])
      out.qdd(i) = qdd[i];
    else
      free.push_back(i);
  }
  const int f = static_cast<int>(free.size());
  const VectorOf<T> inertial = e.M * out.qdd + e.bias, given = e.J * out.qdd;
  MatrixOf<T> K = MatrixOf<T>::Constant(f + m, f + m, T(0));
  VectorOf<T> x(f + m);
  for (int i = 0; i < f; ++i) {
    for (int j = 0; j < f; ++j) K(i, j) = e.M(free[i], free[j]);
    for (int k = 0; k < m; ++k) K(f + k, i) = K(i, f + k) = e.J(k, free[i]);
    x(i) = tau[free[i]] - inertial(free[i]);
  }
  for (int k = 0; k < m; ++k) {
    K(f + k, f + k) = -e.C(k);
    x(f + k) = e.b(k) - given(k);
  }
  recursive::factorize(K);
  recursive::solve(K, x);
  for (int i = 0; i < f; ++i) out.qdd(free[i]) = x(i);
  for (int k = 0; k < m; ++k) out.nu(k) = -x(f + k);
  const VectorOf<T> all = e.M * out.qdd + e.bias - e.J.transpose() * out.nu;
  for (int i = 0; i < n; ++i) out.tau(i) = driven[i] ? all(i) : tau[i];
  return out;
}

}  // namespace dynwitness::crosscheck
