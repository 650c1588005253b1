// SPDX-License-Identifier: Apache-2.0
// Forward dynamics under constraints on the accelerations of links (Popov and Vereshchagin).
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "recursive/articulated_body.hpp"
#include "recursive/semidefinite.hpp"

namespace dynwitness::recursive {

/** Constraints on the acceleration of one link:  A' a = b.                   [chapter, equation 53]

    a is the link's spatial acceleration, in its own frame and without gravity's share: a link that
    falls freely has a = g. For a point of the link at r whose velocity is v_r, the acceleration in
    the ordinary sense is  a.linear + a.angular x r + w x v_r, so the last term belongs into b.

    Each column of A is a wrench in link coordinates about the link's origin. The reaction of an
    ideal constraint acts along the same columns, as the force A nu on the link.

    A soft constraint gives way:  A' a + C nu = b,  C diagonal and positive; nu is then always
    determined. */
template <typename T>
struct LinkConstraint {
  int link = 0;
  Eigen::Matrix<T, 6, Eigen::Dynamic> A;                ///< 6 x m, linear part first
  Eigen::Matrix<T, Eigen::Dynamic, 1> b;                ///< m
  Eigen::Matrix<T, Eigen::Dynamic, 1> compliance = {};  ///< C: m [1/kg], or none: hard
};

/// What the constrained sweeps write on besides the Workspace: sized once for a model and the
/// number of its constraints.
template <typename T>
struct ConstraintWorkspace {
  using Matrix6X = Eigen::Matrix<T, 6, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  ConstraintWorkspace(const Model<T>& model, int count)
      : E(model.links.size(), Matrix6X::Constant(6, count, T(0))),
        e(model.link_of_dof.size(), Vector::Constant(count, T(0))),
        N(MatrixX<T>::Constant(count, count, T(0))),
        of_N(count),
        missing(Vector::Constant(count, T(0))),
        nu(missing),
        added(model.link_of_dof.size(), T(0)) {}

  int count() const { return static_cast<int>(nu.size()); }

  std::vector<Matrix6X> E;     ///< what a link feels of unit constraint forces, joints being free
  std::vector<Vector> e;       ///< Z' E, one a degree of freedom
  MatrixX<T> N;                ///< constraint accelerations of unit constraint forces, m x m
  SemidefiniteSolver<T> of_N;  ///< its rank, and which forces are determined
  Vector missing;        ///< b - A' a of the unconstrained motion; after solving, what contradicts
  Vector nu;             ///< constraint forces
  std::vector<T> added;  ///< what they add to qdd
};

/** Propagates unit constraint forces inward through the free joints,

        (1)  E of a constrained link = its A;   E of p  +=  X' P E,   P = 1 - M_A Z D^-1 Z'
        (2)  N = sum over joints of (Z' E)' D^-1 (Z' E)  =  A' J M^-1 J' A,   and C where it is soft

    into cws.E, cws.e and cws.N; a joint of several axes is passed one axis at a time, in the order
    of forwardDynamics(). Constraints of all links share one matrix, and where branches meet their
    columns add. Costs O(n m^2) for m constraints.

    N is symmetric and positive semidefinite, and definite exactly when the rows of A' J are
    linearly independent: not with redundant constraints, not in a singular pose. C makes it
    definite.

    The articulated inertias (ws.X_up, U, D) must be those of this position: forwardDynamics() or
    hybridDynamics() has run.
    @param driven  by degree of freedom: not 0 where the acceleration is given, so that the joint
      passes forces on as a rigid one does; empty: none is
    @throws std::invalid_argument  a constraint names no link, or A is not 6 x m with m entries of b
 */
template <typename T>
void propagateConstraints(const Model<T>& model, const std::vector<LinkConstraint<T>>& constraints,
                          const Workspace<T>& ws, ConstraintWorkspace<T>& cws,
                          const std::vector<char>& driven = {}) {
  requireOwnRates(model, "propagateConstraints");
  const int n = static_cast<int>(model.links.size());
  for (auto& E : cws.E) E.setConstant(T(0));
  int column = 0;
  for (const LinkConstraint<T>& constraint : constraints) {
    const int m = static_cast<int>(constraint.A.cols());
    if (constraint.link < 0 || constraint.link >= n)
      throw std::invalid_argument("propagateConstraints: link: expected 0 to " +
                                  std::to_string(n - 1) + ", got " +
                                  std::to_string(constraint.link));
    if (constraint.b.size() != m)
      throw std::invalid_argument("propagateConstraints: b: expected " + std::to_string(m) +
                                  " values, one a column of A, got " +
                                  std::to_string(constraint.b.size()));
    if (constraint.compliance.size() != 0 && constraint.compliance.size() != m)
      throw std::invalid_argument("propagateConstraints: compliance: expected none or " +
                                  std::to_string(m) + " values, got " +
                                  std::to_string(constraint.compliance.size()));
    if (column + m > cws.count())
      throw std::invalid_argument("propagateConstraints: workspace: sized for " +
                                  std::to_string(cws.count()) + " constraints, got more");
    cws.E[constraint.link].middleCols(column, m) = constraint.A;  // (1), own
    column += m;
  }
  if (column != cws.count())
    throw std::invalid_argument("propagateConstraints: workspace: sized for " +
                                std::to_string(cws.count()) + " constraints, got " +
                                std::to_string(column));
  cws.N.setConstant(T(0));
  column = 0;
  for (const LinkConstraint<T>& constraint : constraints) {
    for (Eigen::Index k = 0; k < constraint.compliance.size(); ++k)
      cws.N(column + k, column + k) = constraint.compliance(k);
    column += static_cast<int>(constraint.A.cols());
  }
  for (int i = n - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    for (int k = 0; k < cws.count(); ++k) {
      Force<T> E = {cws.E[i].col(k).template head<3>(), cws.E[i].col(k).template tail<3>()};
      for (int axis = 0, d = link.dof; axis < AnyJoints::axes(link); ++axis, ++d) {
        if (!driven.empty() && driven[d]) {
          cws.e[d](k) = T(0);
          continue;
        }
        cws.e[d](k) = AnyJoints::force(link, axis, E);
        const T share = cws.e[d](k) / ws.D[d];
        for (int j = 0; j <= k; ++j) cws.N(k, j) += share * cws.e[d](j);  // (2)
        E = E - ws.U[d] * share;
      }
      if (link.parent >= 0)
        cws.E[link.parent].col(k) += ws.X_up[i].inverseTimes(E).vector();  // (1)
    }
  }
  for (int k = 0; k < cws.count(); ++k)
    for (int j = 0; j < k; ++j) cws.N(j, k) = cws.N(k, j);
}

/** The accelerations that joint forces alone would not cause: qdd of constraint forces nu, by one
    outward sweep,

        (3)  qdd_i = ((Z' E) nu - U' X a_p) / D,   a_i = X a_p + Z qdd_i,   a_0 = 0

    after propagateConstraints(). @param qdd  length n, written whole; ws.a is overwritten */
template <typename T>
void accelerationsOfConstraintForces(const Model<T>& model,
                                     const Eigen::Matrix<T, Eigen::Dynamic, 1>& nu,
                                     const ConstraintWorkspace<T>& cws, Workspace<T>& ws,
                                     std::vector<T>& qdd, const std::vector<char>& driven = {}) {
  requireSize(model, "accelerationsOfConstraintForces", "qdd", qdd.size());
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const LinkModel<T>& link = model.links[i];
    ws.a[i] = link.parent < 0 ? Motion<T>::zero() : ws.X_up[i] * ws.a[link.parent];
    for (int axis = AnyJoints::axes(link) - 1, d = link.dof + axis; axis >= 0; --axis, --d) {
      if (!driven.empty() && driven[d]) {
        qdd[d] = T(0);
        continue;
      }
      qdd[d] = (cws.e[d].dot(nu) - dot(ws.a[i], ws.U[d])) / ws.D[d];  // (3)
      AnyJoints::addMotion(link, axis, qdd[d], ws.a[i]);
    }
  }
}

/** From the motion without constraints (ws.a and qdd) to the one with them: N nu = b - A' a for
    what it misses, then the accelerations that nu adds. ws.a must carry -gravity where `gravity`
    says so. */
template <typename T>
void addConstraintForces(const Model<T>& model, const std::vector<LinkConstraint<T>>& constraints,
                         bool gravity, Workspace<T>& ws, ConstraintWorkspace<T>& cws,
                         std::vector<T>& qdd, const std::vector<char>& driven = {}) {
  propagateConstraints(model, constraints, ws, cws, driven);
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const int p = model.links[i].parent;
    ws.R_W[i] = p < 0 ? ws.X_up[i].R : Matrix3<T>(ws.X_up[i].R * ws.R_W[p]);
  }
  int row = 0;
  for (const LinkConstraint<T>& constraint : constraints) {
    Motion<T> a = ws.a[constraint.link];
    if (gravity) a.linear += ws.R_W[constraint.link] * model.gravity;
    const Vector6<T> a6 = a.vector();
    for (Eigen::Index k = 0; k < constraint.A.cols(); ++k, ++row)
      cws.missing(row) = constraint.b(k) - constraint.A.col(k).dot(a6);
  }
  cws.of_N.factorize(cws.N);
  cws.nu = cws.missing;
  cws.missing = cws.of_N.solve(cws.nu);
  accelerationsOfConstraintForces(model, cws.nu, cws, ws, cws.added, driven);
  for (int k = 0; k < model.dof(); ++k) qdd[k] += cws.added[k];
}

/** Constrained forward dynamics: the qdd and nu with

        M qdd + c + g = tau + Q + J' A nu,      A' (J qdd + dJ/dt qd) + C nu = b

    in O(n m^2 + m^3): the unconstrained motion first, then N nu = b - A' a for what it misses, then
    the accelerations that nu adds. This is the motion of least constraint in the sense of Gauss.

    Redundant constraints are told by the rank of N. The accelerations are those that all of them
    leave; cws.of_N.determined() says which of the forces are (the others are one possible choice),
    and cws.missing by how much constraints contradict each other: zero, unless no motion obeys them
    all.

    The chapter's recursion (section 11.1) sends the same sums inward instead of comparing at the
    link; its nu is the load on the environment, the negative of ours.

    @param  constraints  on any links, several on one link as well
    @param  qdd   length n [rad/s^2, m/s^2];  the forces are left in cws.nu
    @throws std::invalid_argument  sizes do not fit
    @see E. Popov, A. Vereshchagin, S. Zenkevich, Manipulyatsionnye roboty (1978);
         C. Gauss, Ueber ein neues allgemeines Grundgesetz der Mechanik (1829) */
template <typename T>
void constrainedForwardDynamics(const Model<T>& model, const std::vector<JointPosition<T>>& x,
                                const std::vector<T>& qd, const std::vector<T>& tau,
                                const std::vector<LinkConstraint<T>>& constraints, Workspace<T>& ws,
                                ConstraintWorkspace<T>& cws, std::vector<T>& qdd,
                                Terms terms = Terms::all()) {
  forwardDynamics(model, x, qd, tau, ws, qdd, terms);
  addConstraintForces(model, constraints, terms.gravity, ws, cws, qdd);
}

}  // namespace dynwitness::recursive
