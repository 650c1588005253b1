// SPDX-License-Identifier: Apache-2.0
// Forward dynamics of closed loops by sweeps: every loop is eliminated where it closes.
#pragma once

#include <algorithm>

#include "recursive/articulated_step.hpp"
#include "recursive/closure_wrenches.hpp"
#include "recursive/factorization.hpp"
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
  LoopSums(const Model<T>& model, const LoopGroup<T>& group)
      : group(&group),
        E(model.links.size(), MatrixX<T>::Constant(6, group.rows, T(0))),
        e(model.dof(), VectorX<T>::Constant(group.rows, T(0))),
        N(MatrixX<T>::Constant(group.rows, group.rows, T(0))),
        left(VectorX<T>::Constant(group.rows, T(0))),
        solver(group.rows) {}

  bool passes(int link) const {
    return std::binary_search(group->links.begin(), group->links.end(), link);
  }
  /// What link i feels of a unit of one multiplier.
  Force<T> unit(int i, Eigen::Index column) const {
    return {E[i].col(column).template head<3>(), E[i].col(column).template tail<3>()};
  }

  const LoopGroup<T>* group;
  std::vector<MatrixX<T>> E;  ///< by link: unit multipliers as that link feels them, 6 x m
  std::vector<VectorX<T>> e;  ///< by degree of freedom: Z' E
  MatrixX<T> N;               ///< A' a of unit multipliers, the ancestor held
  VectorX<T> left;            ///< b - A' a with lambda = 0, the ancestor held
  SemidefiniteSolver<T> solver;
  VectorX<T> lambda;
};

/// Starts E and left: the wrenches of a group's closures, from how their equations see unit motions
/// of B on A. ws.a: the accelerations at qdd = 0.
template <typename T>
void startLoop(const Constraints<T>& constraints, const Workspace<T>& ws, LoopSums<T>& sum) {
  int column = 0;
  for (const int c : sum.group->closures) {
    const Closure<T>& closure = constraints.closures[c];
    const int a = closure.a, b = closure.b;
    closureWrenches(constraints, closure, [&](int row, const Force<T>& on_a, const Force<T>& on_b) {
      // A' a = A' a(qdd = 0) - gamma; gravity, which a has in it, is on both sides
      T at_rest = T(0);
      if (a >= 0) {
        sum.E[a].col(column) += on_a.vector();
        at_rest += dot(ws.a[a], on_a);
      }
      if (b >= 0) {
        sum.E[b].col(column) += on_b.vector();
        at_rest += dot(ws.a[b], on_b);
      }
      sum.left(column) = at_rest - constraints.gamma(closure.row + row);
      ++column;
    });
  }
}

/// Eliminates a loop at its ancestor, link i:  M_A += E N^-1 E',  f_A -= E N^-1 left.
/// @return whether N is regular; if not, nothing is done
template <typename T>
bool closeLoop(int i, Workspace<T>& ws, LoopSums<T>& sum) {
  const int m = sum.group->rows;
  sum.solver.factorize(sum.N);
  if (sum.solver.rank() < m) return false;
  // N^-1 column by column; E N^-1 E' is added as a sum over rows of symmetric outer products
  MatrixX<T> LDL = sum.N;
  factorize(LDL);
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
  return true;
}

/// Takes a loop through axis k of link i's joint, rate d, which gives way as ws.U, D and u say:
/// with e = Z'E,   N += e e' / D,   left -= e u / D,   E -= U e' / D.
template <typename T>
void passAxis(const Model<T>& model, int i, int k, int d, const Workspace<T>& ws,
              LoopSums<T>& sum) {
  const T inverse_D = T(1) / ws.D[d];
  VectorX<T>& e = sum.e[d];
  for (Eigen::Index j = 0; j < e.size(); ++j)
    e(j) = AnyJoints::force(model.links[i], k, sum.unit(i, j));
  sum.N += e * (e.transpose() * inverse_D);
  sum.left -= e * (ws.u[d] * inverse_D);
  sum.E[i] -= ws.U[d].vector() * (e.transpose() * inverse_D);
}

/// The same of an axis whose acceleration is given: it moves the loop as told, and gives way to
/// nothing:   left -= Z'E qdd.
template <typename T>
void passGivenAxis(const Model<T>& model, int i, int k, const T& qdd, LoopSums<T>& sum) {
  for (Eigen::Index j = 0; j < sum.left.size(); ++j)
    sum.left(j) -= AnyJoints::force(model.links[i], k, sum.unit(i, j)) * qdd;
}

/// Hands a loop on to link i's parent; the world's acceleration is known.
template <typename T>
void handOn(const Model<T>& model, int i, const Motion<T>& carried, const Workspace<T>& ws,
            LoopSums<T>& sum) {
  const int p = model.links[i].parent;
  for (Eigen::Index j = 0; j < sum.left.size(); ++j) {
    const Force<T> E = sum.unit(i, j);
    sum.left(j) -= dot(ws.c[i], E);
    if (p >= 0)
      sum.E[p].col(j) += ws.X_up[i].inverseTimes(E).vector();
    else
      sum.left(j) -= dot(carried, E);
  }
}

/// N lambda = left - E' a of the ancestor, whose acceleration is known now.
template <typename T>
void solveLoop(const Constraints<T>& constraints, const Workspace<T>& ws, LoopSums<T>& sum,
               ClosedMotionResult<T>& out) {
  const int ancestor = sum.group->ancestor;
  sum.lambda = sum.left;
  if (ancestor >= 0)
    for (int j = 0; j < sum.group->rows; ++j)
      sum.lambda(j) -= dot(ws.a[ancestor], sum.unit(ancestor, j));
  else
    sum.solver.factorize(sum.N);
  sum.solver.solve(sum.lambda);
  out.rank += sum.solver.rank();
  int column = 0;
  for (const int c : sum.group->closures) {
    const Closure<T>& closure = constraints.closures[c];
    for (int row = 0; row < scene::equationCount(closure.kind); ++row, ++column) {
      out.lambda(closure.row + row) = sum.lambda(column);
      out.determined[closure.row + row] = sum.solver.determined()[column];
    }
  }
}

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

    Driven joints are no unknowns, as in hybridDynamics(): theirs is what they are told, and loops
    that pass them are moved by it.

    @param constraints  constraintEquations() has run for this state
    @param tau  joint forces, those of springs between points included
    @param driven  by degree of freedom: not 0 where `given` has the acceleration; empty: none is
    Allocates. @see R. Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 8, for the dense
      road */
template <typename T>
ClosedMotionResult<T> closedForwardDynamics(
    const Model<T>& model, const std::vector<JointPosition<T>>& x, const std::vector<T>& qd,
    const std::vector<T>& tau, const Constraints<T>& constraints, Workspace<T>& ws,
    bool at_base = false, const std::vector<char>& driven = {}, const std::vector<T>& given = {}) {
  requirePositions(model, "closedForwardDynamics", x.size());
  requireSize(model, "closedForwardDynamics", "qd", qd.size());
  requireSize(model, "closedForwardDynamics", "tau", tau.size());
  requireOwnRates(model, "closedForwardDynamics");
  if (!driven.empty()) {
    requireSize(model, "closedForwardDynamics", "driven", driven.size());
    requireSize(model, "closedForwardDynamics", "given", given.size());
  }
  const auto isDriven = [&driven](int d) { return !driven.empty() && driven[d]; };
  const int n = static_cast<int>(model.links.size());
  ClosedMotionResult<T> out;
  out.qdd.assign(model.dof(), T(0));
  out.lambda = VectorX<T>::Constant(constraints.rows(), T(0));
  out.determined.assign(constraints.rows(), 1);
  out.groups = detail::loopGroups(model, constraints, at_base);
  ArticulatedSteps<AnyJoints, T> step(model, x, qd, Terms::all(), ws);

  // outward: velocities, what each link alone brings, and accelerations at qdd = 0
  step.start();
  for (int i = 0; i < n; ++i) ws.a[i] = step.carried(i) + ws.c[i];
  std::vector<detail::LoopSums<T>> loops;
  for (const LoopGroup<T>& group : out.groups) {
    loops.emplace_back(model, group);
    detail::startLoop(constraints, ws, loops.back());
  }

  // inward: what each link feels of its subtree, loops eliminated where they close
  for (int i = n - 1; i >= 0; --i) {
    const LinkModel<T>& link = model.links[i];
    std::vector<detail::LoopSums<T>*> through;
    for (detail::LoopSums<T>& loop : loops) {
      if (loop.group->ancestor == i && !detail::closeLoop(i, ws, loop))
        return closedForwardDynamics(model, x, qd, tau, constraints, ws, true, driven, given);
      if (loop.passes(i)) through.push_back(&loop);
    }
    ArticulatedBody<T> body = step.body(i);
    for (int k = 0, d = link.dof; k < AnyJoints::axes(link); ++k, ++d) {
      if (isDriven(d)) {
        for (detail::LoopSums<T>* loop : through)
          detail::passGivenAxis(model, i, k, given[d], *loop);
        step.passGiven(i, k, given[d], body);
        continue;
      }
      step.formEquation(i, k, d, tau[d], body);
      for (detail::LoopSums<T>* loop : through) detail::passAxis(model, i, k, d, ws, *loop);
      step.project(d, body);
    }
    for (detail::LoopSums<T>* loop : through) detail::handOn(model, i, step.carried(i), ws, *loop);
    step.handOn(i, body);
  }

  // outward: multipliers where the ancestor's acceleration is known, and accelerations
  const auto solveLoopsAt = [&](int link) {
    for (detail::LoopSums<T>& loop : loops)
      if (loop.group->ancestor == link) detail::solveLoop(constraints, ws, loop, out);
  };
  solveLoopsAt(-1);
  for (int i = 0; i < n; ++i) {
    step.accelerate(i, out.qdd, [&](int d) {
      if (isDriven(d)) return given[d];
      T u = ws.u[d];
      for (const detail::LoopSums<T>& loop : loops)
        if (loop.passes(i)) u += loop.e[d].dot(loop.lambda);
      return step.acceleration(i, d, u);
    });
    solveLoopsAt(i);
  }
  return out;
}

}  // namespace dynwitness::recursive
