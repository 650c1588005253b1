// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that a mechanism's dynamics must obey, each as two sides that must be equal.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "crosscheck/laws/gauss_value.hpp"
#include "crosscheck/laws/two_sides.hpp"
#include "crosscheck/scalars/dual.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "recursive/joint_forces.hpp"
#include "recursive/projection.hpp"
#include "recursive/regressor.hpp"
#include "recursive/reroot.hpp"
#include "scene/mimic.hpp"

namespace dynwitness::crosscheck {

/// In the order in which Identities::evaluate() returns them.
inline constexpr IdentityInfo kIdentities[] = {
    {"symmetric mass matrix", "M = M'", "M", "newton_euler", ""},
    {"kinetic energy is quadratic", "T = qd' M qd / 2", "kinetic", "newton_euler",
     "composite_body"},
    {"power balance", "d(T + V)/dt = qd' (tau + Q) - (friction's power)", "power", "newton_euler",
     ""},
    {"forward dynamics undoes inverse dynamics", "FD(ID(qdd)) = qdd", "qdd", "articulated_body",
     "newton_euler"},
    {"Coriolis matrix gives c", "C qd = c", "c", "composite_body", "newton_euler"},
    {"skew symmetry", "dM/dt - 2 C = -(dM/dt - 2 C)'", "dM/dt - 2C", "composite_body", ""},
    {"gradient of the potential", "g = dV/dq", "g", "newton_euler", ""},
    {"lumping fixed joints changes nothing", "tau lumped = tau with fixed joints kept", "tau",
     "newton_euler", ""},
    {"duality of transformations", "T_F' T_V = 1", "T", "spatial algebra", ""},
    {"projector", "P P = P - M Z D^-1 d D^-1 Z' with D = d + Z'MZ", "P", "articulated_body", ""},
    {"projected inertia is symmetric", "P M = (P M)'", "P M", "articulated_body", ""},
    {"projected twice", "P M P' = P M - M Z D^-1 d D^-1 Z' M", "P M P'", "articulated_body", ""},
    {"projections of force and motion are dual", "Z' P F = d D^-1 Z' F for every F", "Z' P",
     "articulated_body", ""},
    {"independence of the chosen root",
     "on a floating base, another link as root: the same qdd, and the same twist and acceleration "
     "of every "
     "link",
     "qdd", "articulated_body", ""},
    {"reactions along joint axes", "Z'f = M qdd + C qd + dV/dq - Q - (what rotor and spring take)",
     "tau", "newton_euler", "composite_body"},
    {"reactions at the base", "sum of f = d(momentum)/dt - weight - loads", "reactions",
     "newton_euler", ""},
    {"linear in the inertial parameters", "Y pi = tau without springs and loads", "tau",
     "regressor", "newton_euler"},
    {"value function of Gauss' principle",
     "a' M_A a / 2 + a' f_A = least Gauss function of the subtree, all its joints at once", "M_A",
     "articulated_body", "dense minimum"},
};
inline constexpr int kIdentityCount = sizeof(kIdentities) / sizeof(kIdentities[0]);

/** All identities of one mechanism, in the arithmetic of Numbers. Nothing here is specific to
    rounding: on RunningError the two sides must agree within their bounds, over a field exactly.

    Where M is singular, the laws that divide by an inertia have no sides, and the others do. (A
    scalar that refuses to divide by zero throws std::domain_error; one that goes on, as
    RunningError does, gives sides without a finite bound.) */
template <typename Numbers>
class Identities {
 public:
  using T = typename Numbers::Scalar;
  using MatrixX = recursive::MatrixX<T>;
  using Matrix6 = recursive::Matrix6<T>;
  using Laws = std::vector<TwoSides<T>>;

  Identities(const scene::Mechanism& mechanism, const Numbers& numbers)
      : model_(recursive::buildModel(mechanism, numbers)),
        kept_(recursive::buildModel(mechanism, numbers, recursive::FixedJoints::kKept)),
        free_(mechanism.hasMimics()
                  ? recursive::buildModel(scene::withoutMimics(mechanism), numbers)
                  : model_),
        moving_(recursive::buildModel(mechanism, DualNumbers<Numbers>(numbers),
                                      recursive::FixedJoints::kKept)),
        ws_(model_),
        ws_free_(free_),
        ws_kept_(kept_),
        ws_moving_(moving_),
        parameters_(scene::inertialParameters(mechanism)),
        pi_(recursive::inertialValues(mechanism, parameters_, numbers)) {}

  /// Both sides of each identity at a state (its tau is not used), in the order of kIdentities.
  Laws evaluate(const scene::State<T>& state) {
    const int n = model_.dof();
    const std::vector<T> zeros(n, T(0));
    Laws out;

    // M, by columns: the forces of unit accelerations
    MatrixX M_columns(n, n);
    for (int j = 0; j < n; ++j) {
      std::vector<T> unit = zeros;
      unit[j] = T(1);
      M_columns.col(j) = inverse(state, zeros, unit, recursive::Terms::none());
    }
    out.push_back({M_columns, M_columns.transpose()});

    MatrixX M(n, n);
    recursive::massMatrix(model_, state.x, ws_, M);
    const MatrixX qd = columnOf(state.qd);
    out.push_back({one(recursive::kineticEnergy(model_, state.x, state.qd, ws_)),
                   (qd.transpose() * M * qd) / T(2)});

    // the rate of a quantity along the motion, by dual numbers
    using D = Dual<T>;
    std::vector<scene::JointPosition<D>> x_moving = movingAt(state.x, state.qd);
    std::vector<D> qd_moving;
    for (int i = 0; i < n; ++i) qd_moving.push_back({state.qd[i], state.qdd[i]});
    const D energy = recursive::kineticEnergy(moving_, x_moving, qd_moving, ws_moving_) +
                     recursive::potentialEnergy(moving_, x_moving, ws_moving_);
    recursive::Terms without_loads = recursive::Terms::all();
    without_loads.loads = false;
    const MatrixX tau_and_loads = inverse(state, state.qd, state.qdd, without_loads);
    out.push_back({one(energy.derivative + recursive::frictionPower(model_, state.qd)),
                   qd.transpose() * tau_and_loads});

    const MatrixX tau = inverse(state, state.qd, state.qdd, recursive::Terms::all());
    append(out, 1, [&] {
      std::vector<T> tau_values(n, T(0)), qdd(n, T(0));
      for (int i = 0; i < n; ++i) tau_values[i] = tau(i, 0);
      recursive::forwardDynamics(model_, state.x, state.qd, tau_values, ws_, qdd);
      return Laws{{columnOf(qdd), columnOf(state.qdd)}};
    });

    const MatrixX C = recursive::coriolisMatrix(model_, state.x, state.qd, ws_);
    out.push_back({C * qd, inverse(state, state.qd, zeros, recursive::Terms::none())});

    recursive::MatrixX<D> M_moving(n, n);
    recursive::massMatrix(moving_, x_moving, ws_moving_, M_moving);
    MatrixX skew = C * T(-2);
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) skew(i, j) += M_moving(i, j).derivative;
    out.push_back({skew, skew.transpose() * T(-1)});

    // dV/dq_i: the rate of V when joint i alone moves with unit velocity
    MatrixX gradient(n, 1);
    for (int i = 0; i < n; ++i) {
      std::vector<T> unit = zeros;
      unit[i] = T(1);
      x_moving = movingAt(state.x, unit);
      gradient(i, 0) = recursive::potentialEnergy(moving_, x_moving, ws_moving_).derivative;
    }
    out.push_back({inverse(state, zeros, zeros, recursive::Terms::potential()), gradient});

    std::vector<T> tau_kept(n, T(0));
    recursive::inverseDynamics(kept_, state.x, state.qd, state.qdd, ws_kept_, tau_kept);
    out.push_back({tau, columnOf(tau_kept)});

    inverse(state, zeros, zeros, recursive::Terms::none());  // X_up of all links
    const std::vector<int> moving = movingLinks();
    TwoSides<T> dual = blank(6 * static_cast<int>(moving.size()));
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const auto& X = ws_.X_up[moving[k]];
      set(dual.left, k, X.forceMatrix().transpose() * X.motionMatrix());
      set(dual.right, k, Matrix6::Identity());
    }
    out.push_back(std::move(dual));

    append(out, 4, [&] { return projections(state); });
    append(out, 1, [&] { return Laws{otherRoot(state)}; });

    const MatrixX loads = inverse(state, zeros, zeros, onlyLoads());  // -Q
    out.push_back(alongAxes(state, M * columnOf(state.qdd) + C * qd + gradient + loads));
    out.push_back(atBase(state));
    MatrixX Y(n, parameters_.size());
    recursive::regressor(model_, parameters_, state.x, state.qd, state.qdd, ws_, Y);
    out.push_back(
        {Y * columnOf(pi_), inverse(state, state.qd, state.qdd, {true, false, false, false})});

    append(out, 1, [&] {
      std::vector<T> qdd(free_.dof(), T(0));
      // any forces will do
      const std::vector<T> rates = letGo(state.qd), forces = letGo(state.qdd);
      recursive::forwardDynamics(free_, state.x, rates, forces, ws_free_, qdd,
                                 {true, true, true, false});
      return Laws{
          {sweptGauss(free_, ws_free_), leastGauss(free_, state.x, rates, forces, ws_free_)}};
    });
    return out;
  }

 private:
  /// Appends `count` laws that divide, or why they cannot be asked.
  template <typename Evaluate>
  static void append(Laws& out, int count, Evaluate evaluate) {
    try {
      for (TwoSides<T>& sides : evaluate()) out.push_back(std::move(sides));
    } catch (const std::domain_error& error) {
      out.insert(out.end(), count, {{}, {}, error.what()});
    }
  }

  static MatrixX columnOf(const std::vector<T>& v) {
    return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(v.data(), v.size());
  }
  static MatrixX one(const T& x) { return MatrixX::Constant(1, 1, x); }

  /// Positions that move as they do at these rates.
  std::vector<scene::JointPosition<Dual<T>>> movingAt(const std::vector<scene::JointPosition<T>>& x,
                                                      const std::vector<T>& qd) const {
    std::vector<T> rates(x.size(), T(0));
    recursive::positionRates(model_, x, qd, rates);
    std::vector<scene::JointPosition<Dual<T>>> out;
    for (std::size_t i = 0; i < x.size(); ++i) out.push_back(moving(x[i], rates[i]));
    return out;
  }

  MatrixX inverse(const scene::State<T>& state, const std::vector<T>& qd, const std::vector<T>& qdd,
                  recursive::Terms terms) {
    std::vector<T> tau(model_.dof(), T(0));
    recursive::inverseDynamics(model_, state.x, qd, qdd, ws_, tau, terms);
    return columnOf(tau);
  }

  /// The same rates with one for every joint, where joints that follow others are let go.
  std::vector<T> letGo(const std::vector<T>& rates) const {
    std::vector<T> out(free_.dof(), T(0));
    for (std::size_t i = 0; i < free_.links.size(); ++i) {
      const recursive::LinkModel<T>& link = model_.links[i];
      for (int k = 0; k < recursive::axisCount(link.kind); ++k)
        out[free_.links[i].dof + k] =
            link.follows ? T(link.ratio * rates[link.dof]) : rates[link.dof + k];
    }
    return out;
  }

  /// The identities of section 7 of the chapter at every moving joint, stacked: 6 rows a joint.
  /// They are of joints that are passed one by one, each with a rate of its own.
  Laws projections(const scene::State<T>& state) {
    const int n = free_.dof();
    std::vector<T> qdd(n, T(0));
    // the articulated inertias do not depend on velocities and forces
    recursive::forwardDynamics(free_, state.x, qdd, qdd, ws_free_, qdd);
    const std::vector<int> moving = movingLinks();
    const int rows = 6 * static_cast<int>(moving.size());
    TwoSides<T> projector = blank(rows), symmetric = blank(rows), twice = blank(rows),
                force = blank(n);
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const recursive::LinkModel<T>& link = free_.links[moving[k]];
      const int axes = recursive::axisCount(link.kind);
      const Matrix6 M = ws_free_.M_A[moving[k]].matrix();
      recursive::JointAxes<T> Z(6, axes);
      for (int axis = 0; axis < axes; ++axis) Z.col(axis) = recursive::jointAxis(link, axis);
      const MatrixX d = MatrixX::Identity(axes, axes) * link.rotor;
      const recursive::JointAxes<T> M_Z = M * Z;
      const MatrixX inverse_D = inverse(MatrixX(d + MatrixX(Z.transpose() * M_Z)));
      const MatrixX leak = d * inverse_D;  // what a free joint with a rotor still passes on
      const MatrixX weight = inverse_D * leak;
      const Matrix6 P = recursive::forceProjection(M, Z, d);
      const Matrix6 P_M = recursive::inertiaProjection(M, Z, d);

      set(projector.left, k, P * P);
      set(projector.right, k, P - Matrix6(M_Z * weight * Z.transpose()));
      set(symmetric.left, k, P_M);
      set(symmetric.right, k, P_M.transpose());
      set(twice.left, k, P_M * recursive::accelerationProjection(M, Z, d));
      set(twice.right, k, P_M - Matrix6(M_Z * weight * M_Z.transpose()));
      force.left.middleRows(link.dof, axes) = Z.transpose() * P;
      force.right.middleRows(link.dof, axes) = leak * Z.transpose();
    }
    return {std::move(projector), std::move(symmetric), std::move(twice), std::move(force)};
  }
  /// Links of the model whose joints move.
  std::vector<int> movingLinks() const {
    std::vector<int> moving;
    for (std::size_t i = 0; i < model_.links.size(); ++i)
      if (model_.links[i].dof >= 0) moving.push_back(static_cast<int>(i));
    return moving;
  }
  static recursive::Terms onlyLoads() {
    recursive::Terms terms = recursive::Terms::none();
    terms.loads = true;
    return terms;
  }
  MatrixX reactions(const scene::State<T>& state, recursive::Terms terms) {
    std::vector<T> tau(kept_.dof(), T(0)), out(6 * (kept_.joints.size() - 1), T(0));
    recursive::inverseDynamics(kept_, state.x, state.qd, state.qdd, ws_kept_, tau, terms);
    recursive::jointReactions(kept_, ws_kept_, out);
    return columnOf(out);
  }
  /// The reactions projected on the axes of the joints, and what is left of this tau for the links.
  TwoSides<T> alongAxes(const scene::State<T>& state, MatrixX tau) {
    const MatrixX f = reactions(state, recursive::Terms::all());
    TwoSides<T> sides = {MatrixX::Constant(model_.dof(), 1, T(0)), std::move(tau)};
    for (std::size_t i = 1; i < kept_.joints.size(); ++i) {
      // a chain of parts: the wrench passes through all of them
      recursive::Vector6<T> six = f.block(6 * (static_cast<Eigen::Index>(i) - 1), 0, 6, 1);
      const recursive::ScenePlace<T>& joint = kept_.joints[i];
      recursive::Force<T> through =
          joint.X.inverseTimes(recursive::Force<T>{six.template head<3>(), six.template tail<3>()});
      for (int j = joint.link, end = inboardLink(i); j != end; j = kept_.links[j].parent) {
        const recursive::LinkModel<T>& part = kept_.links[j];
        for (int k = 0; k < recursive::axisCount(part.kind); ++k)
          sides.left(part.dof + k, 0) += recursive::AnyJoints::force(part, k, through);
        if (part.dof >= 0) {
          T taken = part.rotor * state.qdd[part.dof] +
                    part.stiffness * (state.x[part.slot + part.spring_from].q - part.rest);
          if (part.parent >= 0)
            taken += dot(ws_kept_.X_up[j] * ws_kept_.a[part.parent], recursive::spinAxis(part));
          sides.right(part.dof, 0) -= taken;
        }
        through = ws_kept_.X_up[j].inverseTimes(through);
      }
    }
    return sides;
  }
  /// The link of kept_ that the parent of scene link i is; -1: the world.
  int inboardLink(std::size_t i) const {
    int j = kept_.joints[i].link;
    // the links of a chain belong to one joint: those that no scene link is carried by
    do j = kept_.links[j].parent;
    while (j >= 0 && std::none_of(kept_.joints.begin(), kept_.joints.end(),
                                  [j](const auto& joint) { return joint.link == j; }));
    return j;
  }
  /// Six numbers in world axes about the world's origin.
  TwoSides<T> atBase(const scene::State<T>& state) {
    using D = Dual<T>;
    const MatrixX f = reactions(state, recursive::Terms::all());
    recursive::Force<T> sum = recursive::Force<T>::zero();
    for (std::size_t i = 1; i < kept_.joints.size(); ++i) {
      if (inboardLink(i) >= 0) continue;
      recursive::Vector6<T> six = f.block(6 * (static_cast<Eigen::Index>(i) - 1), 0, 6, 1);
      recursive::Force<T> at_world = kept_.joints[i].X.inverseTimes(
          recursive::Force<T>{six.template head<3>(), six.template tail<3>()});
      for (int j = kept_.joints[i].link; j >= 0; j = kept_.links[j].parent)
        at_world = ws_kept_.X_up[j].inverseTimes(at_world);
      sum = sum + at_world;
    }
    // the rate of change of the momentum of the links, by dual numbers
    std::vector<D> qd_moving;
    for (int i = 0; i < model_.dof(); ++i) qd_moving.push_back({state.qd[i], state.qdd[i]});
    const recursive::Force<D> momentum =
        recursive::momentum(moving_, movingAt(state.x, state.qd), qd_moving, ws_moving_);
    // weight and loads: link by link, where they are
    recursive::Force<T> applied = recursive::Force<T>::zero();
    std::vector<recursive::Transform<T>> X_W;  // world to link
    for (std::size_t i = 0; i < kept_.links.size(); ++i) {
      const recursive::LinkModel<T>& link = kept_.links[i];
      X_W.push_back(link.parent < 0 ? ws_kept_.X_up[i] : ws_kept_.X_up[i] * X_W[link.parent]);
      const recursive::RigidInertia<T> M = X_W.back().inverseTimes(link.M);
      applied = applied + recursive::Force<T>{kept_.gravity * M.mass, M.h.cross(kept_.gravity)} +
                X_W.back().inverseTimes(link.load);
    }
    for (const recursive::WorldLoad<T>& load : kept_.world_loads) {
      const recursive::Transform<T>& X = X_W[load.link];
      const recursive::Vector3<T> at = X.p + X.R.transpose() * load.at;
      applied = applied + recursive::Force<T>{load.force, load.moment + at.cross(load.force)};
    }
    MatrixX rate(6, 1);
    for (int k = 0; k < 6; ++k) rate(k, 0) = momentum.vector()(k).derivative;
    return {sum.vector(), rate - MatrixX(applied.vector())};
  }

  /** The mechanism on a base that floats (its own, or what rests in the world is let go), and once
      more with its last link as the root; joints that follow others are let go in both. A base let
      go gets an inertia, a pose and a twist: any will do. */
  TwoSides<T> otherRoot(const scene::State<T>& state) const {
    using namespace recursive;
    const RigidInertia<T> body = {
        T(7), {T(1), T(-2), T(3)}, {T(20), T(30), T(40), T(1), T(-2), T(3)}};
    const bool floats = free_.links[0].kind == scene::JointKind::kFloating &&
                        std::count_if(free_.links.begin(), free_.links.end(),
                                      [](const auto& link) { return link.parent < 0; }) == 1;
    const Model<T> model = floats ? free_ : onFloatingBase(free_, body);
    const int links = static_cast<int>(model.links.size());
    if (links == 1) return {{}, {}, "a single body: there is no other link"};
    const Rerooted<T> tree = reroot(model, links - 1);

    std::vector<JointPosition<T>> x(model.positions, JointPosition<T>{T(0), T(0), T(0)});
    std::vector<T> qd(model.dof(), T(0)), tau(model.dof(), T(0));
    const int pose[] = {1, -2, 3, 2, 1, -1, 3}, twist[] = {1, 2, -1, -3, 1, 2};
    for (int k = 0; k < 7; ++k) x[k].q = T(pose[k]);
    for (int k = 0; k < 6; ++k) qd[k] = T(twist[k]);
    const std::vector<T> rates = letGo(state.qd), forces = letGo(state.qdd);
    std::copy(state.x.begin(), state.x.end(), x.end() - state.x.size());
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
    TwoSides<T> sides = {MatrixX(n + 12 * links, 1), MatrixX(n + 12 * links, 1)};
    for (int k = 0; k < n; ++k) {
      sides.left(k, 0) = qdd_turned[6 + k];
      sides.right(k, 0) = qdd_rooted[6 + k];
    }
    for (int i = 0; i < links; ++i) {
      const int at = n + 12 * i, j = tree.link[i];
      sides.left.block(at, 0, 6, 1) = (tree.X[i] * ws.v[i]).vector();
      sides.right.block(at, 0, 6, 1) = ws_rooted.v[j].vector();
      sides.left.block(at + 6, 0, 6, 1) = (tree.X[i] * ws.a[i]).vector();
      sides.right.block(at + 6, 0, 6, 1) = ws_rooted.a[j].vector();
    }
    return sides;
  }

  /// Of a symmetric matrix.
  static MatrixX inverse(MatrixX D) {
    recursive::factorize(D);
    MatrixX columns = MatrixX::Identity(D.rows(), D.cols());
    for (Eigen::Index j = 0; j < D.cols(); ++j) {
      Eigen::Ref<Eigen::Matrix<T, Eigen::Dynamic, 1>> column = columns.col(j);
      recursive::solve(D, column);
    }
    return columns;
  }
  static TwoSides<T> blank(int rows) {
    return {MatrixX::Constant(rows, 6, T(0)), MatrixX::Constant(rows, 6, T(0))};
  }
  static void set(MatrixX& stack, std::size_t k, const Matrix6& block) {
    stack.block(6 * static_cast<Eigen::Index>(k), 0, 6, 6) = block;
  }

  recursive::Model<T> model_, kept_;
  recursive::Model<T> free_;  ///< joints that follow others let go
  recursive::Model<Dual<T>> moving_;
  recursive::Workspace<T> ws_, ws_free_, ws_kept_;
  recursive::Workspace<Dual<T>> ws_moving_;
  std::vector<scene::InertialParameter> parameters_;
  std::vector<T> pi_;
};

}  // namespace dynwitness::crosscheck
