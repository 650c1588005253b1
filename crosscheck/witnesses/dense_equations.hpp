// SPDX-License-Identifier: GPL-3.0-or-later
// Lagrange's equations of a whole mechanism with multipliers, as one dense system: made by
// derivation or by sweeps, solved the same way, on any scalar.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

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
#include "symbolic/reactions.hpp"

namespace dynwitness::crosscheck {

class DerivedPrograms;
using scene::VectorX;

namespace detail {

/// Twelve numbers a frame (symbolic::frameEquations): where they are, and how they move.
template <typename T>
struct Frames {
  MatrixX<T> place, J, gamma;
};

}  // namespace detail

/** What must hold at a state, rows of closures first, then those of acceleration constraints:

        M qdd + bias = tau + J' nu,      J qdd + C nu = b

    bias = c + g + friction - Q, springs between points in it; C diagonal; qdd of driven joints is
    given, and their tau wanted. */
template <typename T>
struct DenseEquations {
  MatrixX<T> M, J;           ///< n x n, m x n
  VectorX<T> bias, b;        ///< n [N m, N]; m [m/s^2, 1/s^2]
  VectorX<T> C;              ///< m [1/kg]
  detail::Frames<T> frames;  ///< by derivation: of acceleration constraints, then of springs' ends
};

/// What a spring between points pulls, by length: of its length squared, and l l'.
template <typename Numbers>
auto pullByLength(const Numbers& number) {
  using T = typename Numbers::Scalar;
  return [&number](const scene::Spring& spring, const T& l2, const T& l_l_rate) {
    using std::sqrt;
    const T l = sqrt(l2);
    return T((number(spring.stiffness) * (l - number(spring.rest)) +
              number(spring.damping) * (l_l_rate / l)) /
             l);
  };
}

// ---- by derivation ------------------------------------------------------------------------------

/// The equations from T, V and the places of frames in the world, as a program.
struct DerivedConstraints {
  /// @param with_springs  whether the ends of springs between points are asked for
  DerivedConstraints(const scene::Mechanism& mechanism, bool fold_parameters, bool with_springs);
  /// Adds to the graph of what was derived already.
  DerivedConstraints(const DerivedPrograms& derived, bool with_springs);
  symbolic::Program program;
  int n = 0, closure_rows = 0, frames = 0;
};

/// What holds every joint on its link, by cutting it (symbolic::reactionsAlong): its frames are
/// those of DerivedConstraints with springs.
struct DerivedReactions {
  DerivedReactions(const scene::Mechanism& mechanism, bool fold_parameters);
  explicit DerivedReactions(const symbolic::Reactions& cut);
  symbolic::Program program;
  int count = 0, closure_rows = 0, frames = 0;
};

/// Frames that acceleration constraints, and springs, are about.
std::vector<scene::Attachment> constrainedFrames(const scene::Mechanism& mechanism,
                                                 bool with_springs);

namespace detail {

/// Reads numbers off one after the other.
template <typename T>
MatrixX<T> take(const T*& from, Eigen::Index rows, Eigen::Index columns) {
  MatrixX<T> m(rows, columns);
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
      : along(VectorX<T>::Constant(frames.J.cols(), T(0))) {
    const Eigen::Index a = 12 * spring_end, b = a + 12;
    for (int k = 0; k < 3; ++k) {
      const T d = frames.place(b + k, 0) - frames.place(a + k, 0);
      l2 += d * d;
      for (Eigen::Index j = 0; j < along.size(); ++j)
        along(j) += (frames.J(b + k, j) - frames.J(a + k, j)) * d;
    }
  }
  T l2 = T(0);
  VectorX<T> along;
};

/// What springs between points take off the right side: -tau, for a pull  pull(spring, l2, l l') d.
template <typename Numbers, typename T, typename Pull>
VectorX<T> againstSprings(const Frames<T>& frames, Eigen::Index first,
                          const scene::Mechanism& mechanism, const Numbers&,
                          const std::vector<T>& qd, const Pull& pull) {
  VectorX<T> out = VectorX<T>::Constant(static_cast<Eigen::Index>(qd.size()), T(0));
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

/** What acceleration constraint i sees of frames that change so: with x'' of the point and e_a'' of
    the axes,  u . x'' + d . w',   w' = sum of e_a x e_a'' / 2 */
template <typename Numbers, typename T = typename Numbers::Scalar>
struct SeenByConstraint {
  using V3 = Eigen::Matrix<T, 3, 1>;
  SeenByConstraint(const scene::AccelerationConstraint& held, int i, const Numbers& number,
                   const MatrixX<T>& place)
      : first(12 * i) {
    const auto numbers = [&number](const scene::Vector& v) {
      return V3(number(v[0]), number(v[1]), number(v[2]));
    };
    for (int a = 0; a < 3; ++a) axes[a] = place.col(0).template segment<3>(first + 3 + 3 * a);
    u = numbers(held.direction);
    d = numbers(held.rotation);
    if (held.axes != scene::AccelerationConstraint::Axes::kLink) return;
    u = (axes[0] * u(0) + axes[1] * u(1) + axes[2] * u(2)).eval();
    d = (axes[0] * d(0) + axes[1] * d(1) + axes[2] * d(2)).eval();
  }
  template <typename Column>
  T operator()(const Column& column) const {
    T sum = u.dot(V3(column.template segment<3>(first)));
    for (int a = 0; a < 3; ++a)
      sum += d.dot(axes[a].cross(V3(column.template segment<3>(first + 3 + 3 * a)))) / T(2);
    return sum;
  }
  int first;
  V3 axes[3], u, d;
};

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
  const VectorX<T> c = detail::take(from, n, 1), g = detail::take(from, n, 1),
                   Q = detail::take(from, n, 1);
  out.bias = c + g - Q;
  out.J = MatrixX<T>::Constant(m + k, n, T(0));
  out.b = out.C = VectorX<T>::Constant(m + k, T(0));
  detail::take(from, m, 1);  // phi
  out.J.topRows(m) = detail::take(from, m, n);
  out.b.head(m) = detail::take(from, m, 1) * T(-1);
  detail::Frames<T> frames;
  frames.place = detail::take(from, 12 * derived.frames, 1);
  frames.J = detail::take(from, 12 * derived.frames, n);
  frames.gamma = detail::take(from, 12 * derived.frames, 1);
  for (int i = 0; i < k; ++i) {
    const detail::SeenByConstraint<Numbers> seen(held[i], i, number, frames.place);
    for (int j = 0; j < n; ++j) out.J(m + i, j) = seen(frames.J.col(j));
    out.b(m + i) = number(held[i].value) - seen(frames.gamma.col(0));
    out.C(m + i) = number(held[i].compliance);
  }
  if constexpr (kSprings)
    out.bias +=
        detail::againstSprings(frames, k, mechanism, number, state.qd, pullByLength(number));
  out.frames = frames;
  return out;
}

/** Reactions of all joints, 6 a link but the root, from Lagrange's equations of the mechanism whose
    joints are cut and the cuts closed (symbolic::Reactions):

        lambda_cuts - (forces of constraints and springs along the rates of the cuts)

    @param e       derivedEquations() with springs, of the same state
    @param state   qdd that of the whole mechanism
    @param forces  of all equations: rows of closures, then of acceleration constraints
    @param pull    of springs: pullByLength(), or what stands for it */
template <typename Numbers, typename Pull, typename T = typename Numbers::Scalar>
VectorX<T> derivedReactions(const DerivedReactions& derived, const DenseEquations<T>& e,
                            const scene::Mechanism& mechanism, const Numbers& number,
                            const scene::State<T>& state, const VectorX<T>& forces,
                            const Pull& pull) {
  const std::vector<T> values = symbolic::ProgramRun<T>(derived.program, number)(state);
  const T* from = values.data();
  VectorX<T> out = detail::take(from, derived.count, 1);
  const MatrixX<T> by_closure = detail::take(from, derived.closure_rows, derived.count);
  const detail::Frames<T> cuts{
      e.frames.place, detail::take(from, 12 * derived.frames, derived.count), {}};
  const auto& held = mechanism.acceleration_constraints;
  const int k = static_cast<int>(held.size()), m = derived.closure_rows;
  out -= by_closure.transpose() * forces.head(m);
  for (int i = 0; i < k; ++i) {
    const detail::SeenByConstraint<Numbers> seen(held[i], i, number, cuts.place);
    for (int j = 0; j < derived.count; ++j) out(j) -= seen(cuts.J.col(j)) * forces(m + i);
  }
  Eigen::Index end = k;
  for (const scene::Spring& spring : mechanism.springs) {
    const detail::SpringGeometry<T> moved(e.frames, end), cut(cuts, end);
    end += 2;
    T l_l_rate = T(0);
    for (std::size_t j = 0; j < state.qd.size(); ++j)
      l_l_rate += moved.along(static_cast<Eigen::Index>(j)) * state.qd[j];
    out += cut.along * T(pull(spring, cut.l2, l_l_rate));
  }
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
  out.J = MatrixX<T>::Constant(m + k, n, T(0));
  out.b = out.C = VectorX<T>::Constant(m + k, T(0));
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
  out.M = MatrixX<T>(n, n);
  recursive::massMatrix(model, state.x, ws, out.M);
  return out;
}

/** Reactions of all joints by sweeps through the mechanism whose joints are cut (symbolic::freed),
    as the joint forces of the cuts:  M qdd + bias - J' forces  there.
    @param qdd     of the whole mechanism
    @param forces  of all equations: rows of closures, then of acceleration constraints */
template <typename Numbers, typename T = typename Numbers::Scalar>
VectorX<T> cutForces(const symbolic::Freed& cut, const Numbers& number,
                     const scene::State<T>& state, const VectorX<T>& qdd,
                     const VectorX<T>& forces) {
  const scene::Mechanism& mechanism = cut.mechanism;
  const auto model = recursive::buildModel(mechanism, number);
  recursive::Workspace<T> ws(model);
  auto closures = recursive::buildConstraints(mechanism, number, model);
  const int n = model.dof(), m = closures.rows();
  scene::State<T> let_go;
  const std::vector<scene::Number> rest = mechanism.restPosition();
  for (std::size_t i = 0; i < cut.slot.size(); ++i)
    let_go.x.push_back(cut.slot[i] < 0 ? scene::JointPosition<T>{number(rest[i]), T(1), T(0)}
                                       : state.x[static_cast<std::size_t>(cut.slot[i])]);
  for (const int rate : cut.rate) {
    let_go.qd.push_back(rate < 0 ? T(0) : state.qd[static_cast<std::size_t>(rate)]);
    let_go.qdd.push_back(rate < 0 ? T(0) : qdd(rate));
  }
  std::vector<T> pull(n, T(0)), all(n, T(0));
  recursive::constraintEquations(model, let_go.x, let_go.qd, ws, closures);
  recursive::addSpringForces(model, recursive::buildPointSprings(mechanism, number, model),
                             closures.X_W, ws, pull);
  const auto held =
      recursive::accelerationConstraints(mechanism, number, model, let_go.x, let_go.qd, ws);
  recursive::MatrixX<T> J_held(static_cast<Eigen::Index>(held.size()), n);
  if (!held.empty()) recursive::taskJacobian(model, held, ws, J_held);
  recursive::inverseDynamics(model, let_go.x, let_go.qd, let_go.qdd, ws, all);
  const VectorX<T> left = column(all) - column(pull) - closures.J.transpose() * forces.head(m) -
                          J_held.transpose() * forces.tail(J_held.rows());
  VectorX<T> out(std::count(cut.rate.begin(), cut.rate.end(), -1));
  Eigen::Index at = 0;
  for (int i = 0; i < n; ++i)
    if (cut.rate[static_cast<std::size_t>(i)] < 0) out(at++) = left(i);
  return out;
}

// ---- solved -------------------------------------------------------------------------------------

template <typename T>
struct DenseSolution {
  VectorX<T> qdd, nu, tau;  ///< n, m, n
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

/** Whether the pivots of K = L D L' are more than their own rounding: one of j products lies within
    (j + 2) u of the sum of its terms' sizes, |K_jj| + sum_k L_jk^2 |D_k|. Where one does not, its
    sign and size are chance, and no limit of first order knows.
    @throws std::runtime_error  naming the unknown */
inline void requirePivots(const Eigen::MatrixXd& K, const Eigen::MatrixXd& LDL, Eigen::Index n) {
  constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;
  for (Eigen::Index j = 0; j < K.rows(); ++j) {
    double terms = std::abs(K(j, j));
    for (Eigen::Index k = 0; k < j; ++k) terms += LDL(j, k) * LDL(j, k) * std::abs(LDL(k, k));
    if (std::abs(LDL(j, j)) > static_cast<double>(j + 2) * kUnit * terms) continue;
    throw std::runtime_error(fmt::format(
        "{} {}: its pivot {:.1e} is no more than the rounding of terms that sum to {:.1e}",
        j < n ? "free rate" : "constraint equation", (j < n ? j : j - n) + 1, LDL(j, j), terms));
  }
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
  DenseSolution<T> out{VectorX<T>::Constant(n, T(0)), VectorX<T>(m), VectorX<T>(n)};
  for (int i = 0; i < n; ++i) {
    if (driven[i])
      out.qdd(i) = qdd[i];
    else
      free.push_back(i);
  }
  const int f = static_cast<int>(free.size());
  const VectorX<T> inertial = e.M * out.qdd + e.bias, given = e.J * out.qdd;
  MatrixX<T> K = MatrixX<T>::Constant(f + m, f + m, T(0));
  VectorX<T> x(f + m);
  for (int i = 0; i < f; ++i) {
    for (int j = 0; j < f; ++j) K(i, j) = e.M(free[i], free[j]);
    for (int k = 0; k < m; ++k) K(f + k, i) = K(i, f + k) = e.J(k, free[i]);
    x(i) = tau[free[i]] - inertial(free[i]);
  }
  for (int k = 0; k < m; ++k) {
    K(f + k, f + k) = -e.C(k);
    x(f + k) = e.b(k) - given(k);
  }
  const MatrixX<T> before = K;
  recursive::factorize(K);
  if constexpr (std::is_same_v<T, double>) requirePivots(before, K, f);
  recursive::solve(K, x);
  for (int i = 0; i < f; ++i) out.qdd(free[i]) = x(i);
  for (int k = 0; k < m; ++k) out.nu(k) = -x(f + k);
  const VectorX<T> all = e.M * out.qdd + e.bias - e.J.transpose() * out.nu;
  for (int i = 0; i < n; ++i) out.tau(i) = driven[i] ? all(i) : tau[i];
  return out;
}

}  // namespace dynwitness::crosscheck
