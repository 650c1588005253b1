// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that a mechanism's dynamics must obey, each as two sides that must be equal.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "crosscheck/arithmetic/dual.hpp"
#include "recursive/articulated_body.hpp"
#include "recursive/build_model.hpp"
#include "recursive/composite_body.hpp"
#include "recursive/energy.hpp"
#include "recursive/newton_euler.hpp"
#include "recursive/projection.hpp"

namespace dynwitness::crosscheck {

/// An identity in words: how it is called and whose computations it takes.
struct IdentityInfo {
  const char* name;
  const char* statement;
  const char* quantity;
  const char* left;
  const char* right;
};

/// In the order in which Identities::evaluate() returns them.
inline constexpr IdentityInfo kIdentities[] = {
    {"symmetric mass matrix", "M = M'", "M", "newton_euler", ""},
    {"kinetic energy is quadratic", "T = qd' M qd / 2", "kinetic", "newton_euler", "composite_body"},
    {"power balance", "d(T + V)/dt = qd' (tau + Q)", "power", "newton_euler", ""},
    {"forward dynamics undoes inverse dynamics", "FD(ID(qdd)) = qdd", "qdd", "articulated_body",
     "newton_euler"},
    {"Coriolis matrix gives c", "C qd = c", "c", "composite_body", "newton_euler"},
    {"skew symmetry", "dM/dt - 2 C = -(dM/dt - 2 C)'", "dM/dt - 2C", "composite_body", ""},
    {"gradient of the potential", "g = dV/dq", "g", "newton_euler", ""},
    {"lumping fixed joints changes nothing", "tau lumped = tau with fixed joints kept", "tau",
     "newton_euler", ""},
    {"duality of transformations", "T_F' T_V = 1", "T", "spatial algebra", ""},
    {"projector", "P P = P - d/(d + Z'MZ) (1 - P)", "P", "articulated_body", ""},
    {"projected inertia is symmetric", "P M = (P M)'", "P M", "articulated_body", ""},
    {"projected twice", "P M P' = P M - d (MZ)(MZ)'/(d + Z'MZ)^2", "P M P'", "articulated_body", ""},
    {"projections of force and motion are dual", "Z' P F = d/(d + Z'MZ) Z' F for every F", "Z' P",
     "articulated_body", ""},
};
inline constexpr int kIdentityCount = sizeof(kIdentities) / sizeof(kIdentities[0]);

/// What must be equal, or why there is nothing to compare: then both sides are empty.
template <typename T>
struct TwoSides {
  recursive::MatrixX<T> left, right;
  std::string failure = {};
};

/** All identities of one mechanism, in the arithmetic of Numbers. Nothing here is specific to
    rounding: on RunningError the two sides must agree within their bounds, over a field exactly.

    Where M is singular, the laws that divide by an inertia have no sides, and the others do. (A scalar
    that refuses to divide by zero throws std::domain_error; one that goes on, as RunningError does,
    gives sides without a finite bound.) */
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
        moving_(recursive::buildModel(mechanism, DualNumbers<Numbers>(numbers))),
        ws_(model_),
        ws_kept_(kept_),
        ws_moving_(moving_) {}

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
    std::vector<scene::JointPosition<D>> x_moving;
    std::vector<D> qd_moving;
    for (int i = 0; i < n; ++i) {
      x_moving.push_back(moving(state.x[i], state.qd[i]));
      qd_moving.push_back({state.qd[i], state.qdd[i]});
    }
    const D energy = recursive::kineticEnergy(moving_, x_moving, qd_moving, ws_moving_) +
                     recursive::potentialEnergy(moving_, x_moving, ws_moving_);
    const MatrixX tau_and_loads =
        inverse(state, state.qd, state.qdd, recursive::Terms::potential());
    out.push_back({one(energy.derivative), qd.transpose() * tau_and_loads});

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
      for (int j = 0; j < n; ++j) x_moving[j] = moving(state.x[j], T(i == j ? 1 : 0));
      gradient(i, 0) = recursive::potentialEnergy(moving_, x_moving, ws_moving_).derivative;
    }
    out.push_back({inverse(state, zeros, zeros, recursive::Terms::potential()), gradient});

    std::vector<T> tau_kept(n, T(0));
    recursive::inverseDynamics(kept_, state.x, state.qd, state.qdd, ws_kept_, tau_kept);
    out.push_back({tau, columnOf(tau_kept)});

    inverse(state, zeros, zeros, recursive::Terms::none());  // X_up of all links
    TwoSides<T> dual = blank(6 * n);
    for (int k = 0; k < n; ++k) {
      const auto& X = ws_.X_up[model_.link_of_dof[k]];
      set(dual.left, k, X.forceMatrix().transpose() * X.motionMatrix());
      set(dual.right, k, Matrix6::Identity());
    }
    out.push_back(std::move(dual));

    append(out, 4, [&] { return projections(state); });
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

  MatrixX inverse(const scene::State<T>& state, const std::vector<T>& qd,
                  const std::vector<T>& qdd, recursive::Terms terms) {
    std::vector<T> tau(model_.dof(), T(0));
    recursive::inverseDynamics(model_, state.x, qd, qdd, ws_, tau, terms);
    return columnOf(tau);
  }

  /// The identities of section 7 of the chapter at every moving joint, stacked: 6 rows a joint.
  Laws projections(const scene::State<T>& state) {
    std::vector<T> qdd(model_.dof(), T(0));
    // the articulated inertias do not depend on velocities and forces
    recursive::forwardDynamics(model_, state.x, qdd, qdd, ws_, qdd);
    const int n = model_.dof();
    TwoSides<T> projector = blank(6 * n), symmetric = blank(6 * n), twice = blank(6 * n),
                force = blank(n);
    for (int k = 0; k < n; ++k) {
      const int i = model_.link_of_dof[k];
      const recursive::LinkModel<T>& link = model_.links[i];
      const Matrix6 one6 = Matrix6::Identity();
      const Matrix6 M = ws_.M_A[i].matrix();
      const recursive::Vector6<T> Z = recursive::detail::jointAxis(link);
      const recursive::Vector6<T> M_Z = M * Z;
      const T D = link.rotor + Z.dot(M_Z);
      const T leak = link.rotor / D;  // what a free joint with a rotor still passes on
      const Matrix6 P = recursive::forceProjection(M, Z, link.rotor);
      const Matrix6 P_M = recursive::inertiaProjection(M, Z, link.rotor);

      set(projector.left, k, P * P);
      set(projector.right, k, P - (one6 - P) * leak);
      set(symmetric.left, k, P_M);
      set(symmetric.right, k, P_M.transpose());
      set(twice.left, k, P_M * recursive::accelerationProjection(M, Z, link.rotor));
      set(twice.right, k, P_M - (M_Z * (leak / D)) * M_Z.transpose());
      force.left.row(k) = Z.transpose() * P;
      force.right.row(k) = Z.transpose() * leak;
    }
    return {std::move(projector), std::move(symmetric), std::move(twice), std::move(force)};
  }
  static TwoSides<T> blank(int rows) {
    return {MatrixX::Constant(rows, 6, T(0)), MatrixX::Constant(rows, 6, T(0))};
  }
  static void set(MatrixX& stack, int k, const Matrix6& block) {
    stack.block(6 * k, 0, 6, 6) = block;
  }

  recursive::Model<T> model_, kept_;
  recursive::Model<Dual<T>> moving_;
  recursive::Workspace<T> ws_, ws_kept_;
  recursive::Workspace<Dual<T>> ws_moving_;
};

}  // namespace dynwitness::crosscheck
