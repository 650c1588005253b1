// SPDX-License-Identifier: Apache-2.0
// What the joints of a mechanism transmit under closures, springs between points and acceleration
// constraints.
#pragma once

#include <cmath>
#include <vector>

#include "recursive/acceleration_constraints.hpp"
#include "recursive/closure_wrenches.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/operational_space.hpp"
#include "recursive/point_springs.hpp"
#include "recursive/reactions.hpp"
#include "recursive/semidefinite.hpp"

namespace dynwitness::recursive {

/** A mechanism with a link for each of its fixed joints, which transmit wrenches as others do, and
    with its closures, springs between points and acceleration constraints on these links. */
template <typename T>
struct MechanismOfJoints {
  template <typename Numbers>
  MechanismOfJoints(const scene::Mechanism& mechanism, const Numbers& number)
      : model(buildModel(mechanism, number, FixedJoints::kKept)),
        ws(model),
        closures(buildConstraints(mechanism, number, model)),
        springs(buildPointSprings(mechanism, number, model)) {}

  Model<T> model;
  Workspace<T> ws;
  Constraints<T> closures;
  std::vector<PointSpring<T>> springs;
};

namespace detail {

/// Adds to the wrenches on links, in link axes, what multipliers of closures and of acceleration
/// constraints exert.
template <typename T>
void addConstraintWrenches(const Constraints<T>& closures,
                           const std::vector<LinkConstraint<T>>& held, const VectorX<T>& lambda,
                           const VectorX<T>& nu, std::vector<Force<T>>& on_links) {
  const auto add = [&on_links](int link, const Force<T>& f) {
    if (link >= 0) on_links[link] = on_links[link] + f;
  };
  for (const Closure<T>& closure : closures.closures)
    closureWrenches(closures, closure, [&](int k, const Force<T>& on_a, const Force<T>& on_b) {
      add(closure.a, on_a * lambda(closure.row + k));
      add(closure.b, on_b * lambda(closure.row + k));
    });
  Eigen::Index row = 0;
  for (const LinkConstraint<T>& one : held)
    for (Eigen::Index k = 0; k < one.A.cols(); ++k, ++row)
      add(one.link,
          Force<T>{one.A.col(k).template head<3>(), one.A.col(k).template tail<3>()} * nu(row));
}

/// Takes wrenches on links off what passes through the joints inboard of them: ws.f.
template <typename T>
void takeOffInboard(const Model<T>& model, std::vector<Force<T>> on_links, Workspace<T>& ws) {
  for (int i = static_cast<int>(model.links.size()) - 1; i >= 0; --i) {
    ws.f[i] = ws.f[i] - on_links[i];
    const int p = model.links[i].parent;
    if (p >= 0) on_links[p] = on_links[p] + ws.X_up[i].inverseTimes(on_links[i]);
  }
}

/// constrainedReactions() with springs as `addSprings(tau)` has them: it leaves their wrenches,
/// carried inward, in of.ws.f.
template <typename Numbers, typename AddSprings, typename T = typename Numbers::Scalar>
void reactionsUnder(const scene::Mechanism& mechanism, const Numbers& number,
                    const std::vector<JointPosition<T>>& x, const std::vector<T>& qd,
                    const std::vector<T>& qdd, const VectorX<T>& lambda, const VectorX<T>& nu,
                    const AddSprings& addSprings, MechanismOfJoints<T>& of, std::vector<T>& out) {
  std::vector<T> tau(of.model.dof(), T(0));
  const auto held = accelerationConstraints(mechanism, number, of.model, x, qd, of.ws);
  constraintEquations(of.model, x, qd, of.ws, of.closures);
  addSprings(tau);
  // of springs already carried inward, which is how their joint forces are found
  const std::vector<Force<T>> of_springs = of.ws.f;
  inverseDynamics(of.model, x, qd, qdd, of.ws, tau);
  if (!of.springs.empty())
    for (std::size_t i = 0; i < of_springs.size(); ++i) of.ws.f[i] = of.ws.f[i] - of_springs[i];
  std::vector<Force<T>> on_links(of.model.links.size(), Force<T>::zero());
  addConstraintWrenches(of.closures, held, lambda, nu, on_links);
  takeOffInboard(of.model, on_links, of.ws);
  jointReactions(of.model, of.ws, out);
}

}  // namespace detail

/** The wrench that the parent exerts on the link through each joint of the tree, where closures,
    springs between points and acceleration constraints act on the links as well: the sweeps of
    inverseDynamics() with their wrenches as outer loads,

        f_i = M_i a_i + v_i x* M_i v_i - loads - springs - sum of w lambda - A nu
              + sum over children of X' f_child

    w: closureWrenches(). What drives and motors do is in f_i, as in jointReactions().

    @param qdd, lambda, nu  of the whole mechanism, all its equations (closedForwardDynamics(),
      hybridDynamics()); which lambda, where closures are redundant, decides what is returned: see
      determinedReactions()
    @param out  6 numbers a link of the scene but its root, as jointReactions() has them */
template <typename Numbers, typename T = typename Numbers::Scalar>
void constrainedReactions(const scene::Mechanism& mechanism, const Numbers& number,
                          const std::vector<JointPosition<T>>& x, const std::vector<T>& qd,
                          const std::vector<T>& qdd, const VectorX<T>& lambda, const VectorX<T>& nu,
                          MechanismOfJoints<T>& of, std::vector<T>& out) {
  detail::reactionsUnder(
      mechanism, number, x, qd, qdd, lambda, nu,
      [&of](std::vector<T>& tau) {
        addSpringForces(of.model, of.springs, of.closures.X_W, of.ws, tau);
      },
      of, out);
}

/** Which of these numbers the equations of motion determine. Redundant constraints leave
    multipliers open by every y with J' y = 0 of the free rates (and C y = 0), and a reaction whose
    change with the multipliers is w does not depend on them where w'y = 0 for all of these: where w
    is a combination of the columns of J.

    @param driven  by degree of freedom: not 0 where a drive gives the motion
    @return  by number: 0 where redundant constraints leave it open. Pivots of rounding numbers are
      zero as SemidefiniteSolver has it, and what w lacks by the measure of lengths there: cbrt(eps)
      of the largest force or moment, whichever it is, that a unit multiplier does */
template <typename Numbers, typename T = typename Numbers::Scalar>
std::vector<char> determinedReactions(const scene::Mechanism& mechanism, const Numbers& number,
                                      const std::vector<JointPosition<T>>& x,
                                      const std::vector<T>& qd, const std::vector<char>& driven,
                                      MechanismOfJoints<T>& of) {
  using std::abs;
  const auto held = accelerationConstraints(mechanism, number, of.model, x, qd, of.ws);
  constraintEquations(of.model, x, qd, of.ws, of.closures);
  const Eigen::Index n = of.model.dof(), k = static_cast<Eigen::Index>(held.size()),
                     closure_rows = of.closures.rows(), m = closure_rows + k;
  MatrixX<T> J_held(k, n), J = MatrixX<T>::Constant(m, n, T(0));
  taskJacobian(of.model, held, of.ws, J_held);
  J.topRows(closure_rows) = of.closures.J;
  J.bottomRows(k) = J_held;
  for (Eigen::Index i = 0; i < n; ++i)
    if (driven[i]) J.col(i).setConstant(T(0));
  MatrixX<T> N = J * J.transpose();
  for (Eigen::Index i = 0; i < k; ++i)
    N(closure_rows + i, closure_rows + i) += held[i].compliance(0);
  SemidefiniteSolver<T> solver(static_cast<int>(m));
  solver.factorize(N);
  const Eigen::Index count = 6 * (static_cast<Eigen::Index>(of.model.joints.size()) - 1);
  std::vector<char> determined(count, 1);
  if (solver.rank() == m) return determined;

  MatrixX<T> W(count, m);
  for (Eigen::Index j = 0; j < m; ++j) {
    VectorX<T> unit = VectorX<T>::Constant(m, T(0));
    unit(j) = T(1);
    std::vector<Force<T>> on_links(of.model.links.size(), Force<T>::zero());
    for (Force<T>& f : of.ws.f) f = Force<T>::zero();
    detail::addConstraintWrenches<T>(of.closures, held, unit.head(closure_rows), unit.tail(k),
                                     on_links);
    detail::takeOffInboard(of.model, on_links, of.ws);
    std::vector<T> column(count, T(0));
    jointReactions(of.model, of.ws, column);
    for (Eigen::Index i = 0; i < count; ++i) W(i, j) = column[i];
  }
  T largest[] = {T(0), T(0)};  // of forces, of moments
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < m; ++j)
      if (abs(W(i, j)) > largest[i / 3 % 2]) largest[i / 3 % 2] = abs(W(i, j));
  for (Eigen::Index i = 0; i < count; ++i) {
    VectorX<T> w = W.row(i).transpose();
    const VectorX<T> lacks = solver.solve(w);
    for (Eigen::Index j = 0; j < m; ++j)
      if (abs(lacks(j)) > detail::cubeRootOfEpsilon<T>() * largest[i / 3 % 2]) determined[i] = 0;
  }
  return determined;
}

}  // namespace dynwitness::recursive
