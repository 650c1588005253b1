// SPDX-License-Identifier: Apache-2.0
// Forward dynamics of closed loops by sweeps: every loop is eliminated where it closes.
#pragma once

#include <algorithm>

#include "recursive/constraints.hpp"
#include "recursive/factorization.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/semidefinite.hpp"

namespace dynwitness::recursive {

/// Loops that share a joint are eliminated together, at the last link (or the world) that all of
/// them hang on.
template <typename T>
struct LoopGroup {
  int ancestor;               ///< -1: the world
  std::vector<int> closures;  ///< of Constraints
  std::vector<int>
      links;  ///< on the ways from the closures' ends to the ancestor, it not among them
  int rows = 0;
};

template <typename T>
struct ClosedMotionResult {
  std::vector<T> qdd;
  VectorX<T> lambda;             ///< in the order of the closure equations
  std::vector<char> determined;  ///< by multiplier
  int rank = 0;                  ///< of all equations
  std::vector<LoopGroup<T>> groups;
};

namespace detail {

/// Which loops go together. @param at_base  whether all are taken to the world
template <typename T>
std::vector<LoopGroup<T>> loopGroups(const Model<T>& model, const Constraints<T>& constraints,
                                     bool at_base) {
  const auto isOnWay = [&](int from, int link) {
    for (int i = from; i >= 0; i = model.links[i].parent)
      if (i == link) return true;
    return false;
  };
  const auto commonAncestor = [&](int a, int b) {
    while (b >= 0 && !isOnWay(a, b)) b = model.links[b].parent;
    return b;
  };
  std::vector<LoopGroup<T>> groups;
  const auto setLinks = [&](LoopGroup<T>& group) {
    std::vector<char> on(model.links.size(), 0);
    for (const int c : group.closures)
      for (const int end : {constraints.closures[c].a, constraints.closures[c].b})
        for (int i = end; i >= 0 && i != group.ancestor; i = model.links[i].parent) on[i] = 1;
    group.links.clear();
    for (int i = 0; i < static_cast<int>(on.size()); ++i)
      if (on[i]) group.links.push_back(i);
  };
  for (int c = 0; c < static_cast<int>(constraints.closures.size()); ++c) {
    const Closure<T>& closure = constraints.closures[c];
    LoopGroup<T> group;
    group.ancestor = at_base ? -1 : commonAncestor(closure.a, closure.b);
    group.closures = {c};
    group.rows = scene::equationCount(closure.kind);
    setLinks(group);
    // one that shares a joint with another joins it, which may make it meet a third
    for (std::size_t g = 0; g < groups.size();) {
      const bool meets = std::any_of(group.links.begin(), group.links.end(), [&](int link) {
        return std::binary_search(groups[g].links.begin(), groups[g].links.end(), link);
      });
      if (!meets) {
        ++g;
        continue;
      }
      group.ancestor = commonAncestor(group.ancestor, groups[g].ancestor);
      group.closures.insert(group.closures.end(), groups[g].closures.begin(),
                            groups[g].closures.end());
      group.rows += groups[g].rows;
      groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(g));
      setLinks(group);
      g = 0;
    }
    groups.push_back(group);
  }
  return groups;
}

/// What a group carries through its links.
template <typename T>
struct LoopSums {
  std::vector<MatrixX<T>> E;  ///< by link: unit multipliers as that link feels them, 6 x m
  std::vector<VectorX<T>> e;  ///< by degree of freedom: Z' E
  MatrixX<T> N;               ///< A' a of unit multipliers, the ancestor held
  VectorX<T> left;            ///< b - A' a with lambda = 0, the ancestor held
  VectorX<T> lambda;
};

}  // namespace detail

/** Forward dynamics of a mechanism with closures:

        M qdd + bias = tau + J' lambda,      J qdd + gamma = 0

    by the articulated-body sweeps. A closure between links a and b is a pair of wrenches, -w on one
    and +w on the other, and asks  A_a' a_a + A_b' a_b = b  of their accelerations. Both are carried
    inward through the free joints (propagateConstraints); at the common ancestor k nothing more of
    the loop is outboard,

        N lambda = left - E' a_k,      and so     M_A,k += E N^-1 E',    f_A,k -= E N^-1 left

    after which the rest of the mechanism need not know that there was a loop: O(n) and a system of
    the size of each loop, instead of one of all. Loops that share joints are one group. Where N is
    singular, all is done at the world, by rank: qdd is right, and determined says which multipliers
    are.

    @param constraints  constraintEquations() has run for this state
    @param tau  joint forces, those of springs between points included Allocates. @see R.
      Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 8, for the dense road */
template <typename T>
ClosedMotionResult<T> closedForwardDynamics(const Model<T>& model,
                                            const std::vector<JointPosition<T>>& x,
                                            const std::vector<T>& qd, const std::vector<T>& tau,
                                            const Constraints<T>& constraints, Workspace<T>& ws,
                                            bool at_base = false) {
  requirePositions(model, "closedForwardDynamics", x.size());
  requireSize(model, "closedForwardDynamics", "qd", qd.size());
  requireSize(model, "closedForwardDynamics", "tau", tau.size());
  requireOwnRates(model, "closedForwardDynamics");
  const int n = static_cast<int>(model.links.size());
  ClosedMotionResult<T> out;
  out.qdd.assign(model.dof(), T(0));
  out.lambda = VectorX<T>::Constant(constraints.rows(), T(0));
  out.determined.assign(constraints.rows(), 1);
  out.groups = detail::loopGroups(model, constraints, at_base);
  Motion<T> a_0 = Motion<T>::zero();
  a_0.linear = -model.gravity;

  // outward: velocities, what each link alone brings, and accelerations at qdd = 0
  linkVelocities(model, x, qd, ws);
  for (int i = 0; i < n; ++i) {
    const LinkModel<T>& link = model.links[i];
    ws.c[i] = cross(ws.v[i], AnyJoints::motion(link, qd));
    ws.a[i] = ws.X_up[i] * (link.parent < 0 ? a_0 : ws.a[link.parent]) + ws.c[i];
    ws.M_A[i] = ArticulatedInertia<T>::fromRigid(link.M);
    ws.f[i] = biasForce(link.M, ws.v[i]);
  }
  subtractLoads(model, ws, ws.f);

  // the wrenches of each closure, from how its equations see unit motions of B on A
  std::vector<detail::LoopSums<T>> sums(out.groups.size());
  for (std::size_t g = 0; g < sums.size(); ++g) {
    const int m = out.groups[g].rows;
    detail::LoopSums<T>& sum = sums[g];
    sum.E.assign(n, MatrixX<T>::Constant(6, m, T(0)));
    sum.e.assign(model.dof(), VectorX<T>::Constant(m, T(0)));
    sum.N = MatrixX<T>::Constant(m, m, T(0));
    sum.left = VectorX<T>::Constant(m, T(0));
    int column = 0;
    for (const int c : out.groups[g].closures) {
      const Closure<T>& closure = constraints.closures[c];
      const int a = closure.a, b = closure.b, rows = scene::equationCount(closure.kind);
      const Transform<T> X_AW = a < 0 ? closure.X_A : closure.X_A * constraints.X_W[a];
      const Transform<T> X_BW = b < 0 ? closure.X_B : closure.X_B * constraints.X_W[b];
      const Transform<T> X_BA = X_BW * X_AW.inverse();
      MatrixX<T> w(6, rows);
      for (int k = 0; k < 6; ++k) {
        Motion<T> unit = Motion<T>::zero();
        (k < 3 ? unit.linear(k) : unit.angular(k - 3)) = T(1);
        detail::closureRates(closure.kind, unit, X_BA,
                             [&](int row, const T& rate) { w(k, row) = rate; });
      }
      for (int row = 0; row < rows; ++row, ++column) {
        const Force<T> in_A = {w.col(row).template head<3>(), w.col(row).template tail<3>()};
        // A' a = A' a(qdd = 0) - gamma; gravity, which a has in it, is on both sides
        T at_rest = T(0);
        if (a >= 0) {
          const Force<T> f = closure.X_A.inverseTimes(in_A);
          sum.E[a].col(column) -= f.vector();
          at_rest -= dot(ws.a[a], f);
        }
        if (b >= 0) {
          const Force<T> f = closure.X_B.inverseTimes(X_BA * in_A);
          sum.E[b].col(column) += f.vector();
          at_rest += dot(ws.a[b], f);
        }
        sum.left(column) = at_rest - constraints.gamma(closure.row + row);
      }
    }
  }
  std::vector<SemidefiniteSolver<T>> solvers;
  for (const LoopGroup<T>& group : out.groups) solvers.emplace_back(group.rows);

  // inward: what each link feels of its subtree, loops eliminated where they close
  for (int i = n - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    for (std::size_t g = 0; g < sums.size(); ++g) {
      if (out.groups[g].ancestor != i) continue;
      detail::LoopSums<T>& sum = sums[g];
      solvers[g].factorize(sum.N);
      if (solvers[g].rank() < out.groups[g].rows)
        return closedForwardDynamics(model, x, qd, tau, constraints, ws, true);
      // N^-1 column by column; E N^-1 E' is added as a sum over rows of symmetric outer products
      MatrixX<T> LDL = sum.N;
      factorize(LDL);
      const int m = out.groups[g].rows;
      MatrixX<T> F = sum.E[i];  // E L'^-1
      for (int k = 0; k < m; ++k)
        for (int j = 0; j < k; ++j) F.col(k) -= F.col(j) * LDL(k, j);
      for (int k = 0; k < m; ++k) {
        const Force<T> f = {F.col(k).template head<3>(), F.col(k).template tail<3>()};
        ws.M_A[i] = ws.M_A[i].minusOuter(f, -T(1) / LDL(k, k));
      }
      VectorX<T> lambda = sum.left;
      solve(LDL, lambda);
      const Vector6<T> f = sum.E[i] * lambda;
      ws.f[i] = ws.f[i] - Force<T>{f.template head<3>(), f.template tail<3>()};
    }
    ArticulatedInertia<T> M_a = ws.M_A[i];
    Force<T> f_a = ws.f[i];
    std::vector<detail::LoopSums<T>*> through;
    for (std::size_t g = 0; g < sums.size(); ++g)
      if (std::binary_search(out.groups[g].links.begin(), out.groups[g].links.end(), i))
        through.push_back(&sums[g]);
    for (int k = 0, d = link.dof; k < AnyJoints::axes(link); ++k, ++d) {
      ws.U[d] = AnyJoints::column(link, k, M_a);
      ws.D[d] = link.rotor + AnyJoints::force(link, k, ws.U[d]);
      ws.u[d] = tau[d] - AnyJoints::force(link, k, f_a) -
                link.stiffness * (x[link.slot + link.spring_from].q - link.rest);
      if (model.friction) ws.u[d] -= frictionForce(link, qd[d]);
      if (model.gyroscopic && link.parent >= 0) ws.U[d] = ws.U[d] + spinAxis(link);
      const T inverse_D = T(1) / ws.D[d];
      for (detail::LoopSums<T>* sum : through) {
        MatrixX<T>& E = sum->E[i];
        for (Eigen::Index j = 0; j < E.cols(); ++j)
          sum->e[d](j) = AnyJoints::force(
              link, k, Force<T>{E.col(j).template head<3>(), E.col(j).template tail<3>()});
        sum->N += sum->e[d] * (sum->e[d].transpose() * inverse_D);
        sum->left -= sum->e[d] * (ws.u[d] * inverse_D);
        E -= ws.U[d].vector() * (sum->e[d].transpose() * inverse_D);
      }
      M_a = M_a.minusOuter(ws.U[d], inverse_D);
      f_a = f_a + ws.U[d] * (ws.u[d] * inverse_D);
    }
    for (detail::LoopSums<T>* sum : through)
      for (Eigen::Index j = 0; j < sum->left.size(); ++j) {
        const Force<T> E = {sum->E[i].col(j).template head<3>(),
                            sum->E[i].col(j).template tail<3>()};
        sum->left(j) -= dot(ws.c[i], E);
        if (link.parent >= 0)
          sum->E[link.parent].col(j) += ws.X_up[i].inverseTimes(E).vector();
        else
          sum->left(j) -= dot(ws.X_up[i] * a_0, E);
      }
    if (link.parent < 0) continue;
    if (model.gyroscopic && link.dof >= 0)
      f_a = f_a + spinForce(link, qd[link.dof], T(0), ws.X_up[i] * ws.v[link.parent]);
    ws.M_A[link.parent] = ws.M_A[link.parent] + ws.X_up[i].inverseTimes(M_a);
    ws.f[link.parent] = ws.f[link.parent] + ws.X_up[i].inverseTimes(f_a + M_a * ws.c[i]);
  }

  // outward: multipliers where the ancestor's acceleration is known, and accelerations
  const auto settle = [&](int link) {
    for (std::size_t g = 0; g < sums.size(); ++g) {
      const LoopGroup<T>& group = out.groups[g];
      if (group.ancestor != link) continue;
      detail::LoopSums<T>& sum = sums[g];
      sum.lambda = sum.left;
      if (link >= 0) {
        for (int j = 0; j < group.rows; ++j) {
          const Force<T> E = {sum.E[link].col(j).template head<3>(),
                              sum.E[link].col(j).template tail<3>()};
          sum.lambda(j) -= dot(ws.a[link], E);
        }
      } else {
        solvers[g].factorize(sum.N);
      }
      solvers[g].solve(sum.lambda);
      out.rank += solvers[g].rank();
      int column = 0;
      for (const int c : group.closures)
        for (int row = 0; row < scene::equationCount(constraints.closures[c].kind);
             ++row, ++column) {
          out.lambda(constraints.closures[c].row + row) = sum.lambda(column);
          out.determined[constraints.closures[c].row + row] = solvers[g].determined()[column];
        }
    }
  };
  settle(-1);
  for (int i = 0; i < n; ++i) {
    const LinkModel<T>& link = model.links[i];
    ws.a[i] = ws.X_up[i] * (link.parent < 0 ? a_0 : ws.a[link.parent]) + ws.c[i];
    for (int k = AnyJoints::axes(link) - 1, d = link.dof + k; k >= 0; --k, --d) {
      T u = ws.u[d];
      for (std::size_t g = 0; g < sums.size(); ++g)
        if (std::binary_search(out.groups[g].links.begin(), out.groups[g].links.end(), i))
          u += sums[g].e[d].dot(sums[g].lambda);
      out.qdd[d] = (u - dot(ws.a[i], ws.U[d])) / ws.D[d];
      AnyJoints::addMotion(link, k, out.qdd[d], ws.a[i]);
    }
    settle(i);
  }
  return out;
}

}  // namespace dynwitness::recursive
