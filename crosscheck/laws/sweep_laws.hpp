// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of sweeps: what one leaves unchanged, undoes, or depends on linearly.
#pragma once

#include <algorithm>
#include <vector>

#include "crosscheck/laws/swept_mechanism.hpp"
#include "recursive/reroot.hpp"

namespace dynwitness::crosscheck {

struct ForwardUndoesInverse : Law {
  static constexpr LawWords kWords = {"forward dynamics undoes inverse dynamics",
                                      "FD(ID(qdd)) = qdd", "qdd", "articulated_body",
                                      "newton_euler"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    return {at.forward(at.tau()), at.qdd()};
  }
};

struct LumpingFixedJoints : Law {
  static constexpr LawWords kWords = {"lumping fixed joints changes nothing",
                                      "tau lumped = tau with fixed joints kept", "tau",
                                      "newton_euler", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    return {at.tau(), at.tauWithFixedJoints()};
  }
};

struct DualityOfTransformations : Law {
  static constexpr LawWords kWords = {"duality of transformations", "T_F' T_V = 1", "T",
                                      "spatial algebra", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const std::vector<int> moving = at.movingLinks();
    const Eigen::Index rows = 6 * static_cast<Eigen::Index>(moving.size());
    TwoSides<T> sides = {recursive::MatrixX<T>(rows, 6), recursive::MatrixX<T>(rows, 6)};
    Eigen::Index row = 0;
    for (const int i : moving) {
      const recursive::Transform<T>& X = at.transforms()[i];
      sides.left.middleRows(row, 6) = X.forceMatrix().transpose() * X.motionMatrix();
      sides.right.middleRows(row, 6) = recursive::Matrix6<T>::Identity();
      row += 6;
    }
    return sides;
  }
};

/** The mechanism on a base that floats (its own, or what rests in the world is let go), and once
    more with its last link as the root; joints that follow others are let go in both. A base let
    go gets an inertia, a pose and a twist: any will do. */
struct IndependenceOfTheRoot : Law {
  static constexpr LawWords kWords = {
      "independence of the chosen root",
      "on a floating base, another link as root: the same qdd, and the same twist and acceleration "
      "of every "
      "link",
      "qdd", "articulated_body", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using namespace recursive;
    const RigidInertia<T> body = {
        T(7), {T(1), T(-2), T(3)}, {T(20), T(30), T(40), T(1), T(-2), T(3)}};
    const Model<T>& own = at.letGo();
    // where nothing moves there is no link
    const bool floats = !own.links.empty() && own.links[0].kind == scene::JointKind::kFloating &&
                        std::count_if(own.links.begin(), own.links.end(),
                                      [](const auto& link) { return link.parent < 0; }) == 1;
    const Model<T> model = floats ? own : onFloatingBase(own, body);
    const int links = static_cast<int>(model.links.size());
    if (links == 1) return {{}, {}, "a single body: there is no other link", true};
    const Rerooted<T> tree = reroot(model, links - 1);

    const std::vector<JointPosition<T>>& positions = at.state().x;
    std::vector<JointPosition<T>> x(model.positions, JointPosition<T>{T(0), T(0), T(0)});
    std::vector<T> qd(model.dof(), T(0)), tau(model.dof(), T(0));
    const int pose[] = {1, -2, 3, 2, 1, -1, 3}, twist[] = {1, 2, -1, -3, 1, 2};
    for (int k = 0; k < 7; ++k) x[k].q = T(pose[k]);
    for (int k = 0; k < 6; ++k) qd[k] = T(twist[k]);
    const std::vector<T> rates = at.letGo(at.state().qd), forces = at.letGo(at.state().qdd);
    std::copy(positions.begin(), positions.end(), x.end() - positions.size());
    std::copy(rates.begin(), rates.end(), qd.end() - rates.size());
    std::copy(forces.begin(), forces.end(), tau.end() - forces.size());  // any forces will do
    std::fill(tau.begin(), tau.begin() + 6, T(0));  // those on the base would be on another link

    Workspace<T> ws(model), ws_rooted(tree.model);
    std::vector<T> qdd(tau), qdd_rooted(tau);
    forwardDynamics(model, x, qd, tau, ws, qdd);
    std::vector<T> qdd_turned(qdd);
    rerootRates(tree, x, qdd_turned);
    rerootForces(tree, x, tau);
    rerootState(model, tree, ws, x, qd);
    forwardDynamics(tree.model, x, qd, tau, ws_rooted, qdd_rooted);

    const int n = model.dof() - 6;
    TwoSides<T> sides = {MatrixX<T>(n + 12 * links, 1), MatrixX<T>(n + 12 * links, 1)};
    for (int k = 0; k < n; ++k) {
      sides.left(k, 0) = qdd_turned[6 + k];
      sides.right(k, 0) = qdd_rooted[6 + k];
    }
    for (int i = 0; i < links; ++i) {
      const int row = n + 12 * i, j = tree.link[i];
      sides.left.block(row, 0, 6, 1) = (tree.X[i] * ws.v[i]).vector();
      sides.right.block(row, 0, 6, 1) = ws_rooted.v[j].vector();
      sides.left.block(row + 6, 0, 6, 1) = (tree.X[i] * ws.a[i]).vector();
      sides.right.block(row + 6, 0, 6, 1) = ws_rooted.a[j].vector();
    }
    return sides;
  }
};

struct LinearInInertialParameters : Law {
  static constexpr LawWords kWords = {"linear in the inertial parameters",
                                      "Y pi = tau without springs and loads", "tau", "regressor",
                                      "newton_euler"};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    const recursive::Terms gravity_alone = {true, false, false, false};
    return {at.regressed(), at.inverse(at.state().qd, at.state().qdd, gravity_alone)};
  }
};

}  // namespace dynwitness::crosscheck
