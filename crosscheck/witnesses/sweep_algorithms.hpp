// SPDX-License-Identifier: GPL-3.0-or-later
// Which sweep answers which quantity, on any scalar.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "crosscheck/witnesses/bounded_answer.hpp"
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/solved_by.hpp"
#include "recursive/factorization.hpp"

namespace dynwitness::crosscheck {

using recursive::Terms;

/// What a sweep witness is built on, for one scalar.
template <typename T>
struct Setup {
  explicit Setup(recursive::Model<T> m) : model(std::move(m)), ws(model) {}
  /// With what reactions() asks for.
  template <typename Numbers>
  Setup(const scene::Mechanism& mechanism, const Numbers& number)
      : Setup(recursive::buildModel(mechanism, number)) {
    if (isLumped())
      with_fixed_joints.emplace_back(
          recursive::buildModel(mechanism, number, recursive::FixedJoints::kKept));
  }
  explicit Setup(const PreparedScene& scene) : Setup(scene.model<T>()) {
    if (isLumped()) with_fixed_joints.emplace_back(scene.modelWithFixedJoints<T>());
  }

  /// tau for the given velocities, accelerations and terms.
  MatrixX<T> inverse(const scene::State<T>& state, const std::vector<T>& qd,
                     const std::vector<T>& qdd, Terms terms) {
    std::vector<T> tau(model.dof(), T(0));
    recursive::inverseDynamics(model, state.x, qd, qdd, ws, tau, terms);
    return column(tau);
  }
  /// The wrenches through all joints of the scene, at state.qdd.
  MatrixX<T> reactions(const scene::State<T>& state) {
    Setup& kept = with_fixed_joints.empty() ? *this : with_fixed_joints.front();
    kept.inverse(state, state.qd, state.qdd, Terms::all());
    std::vector<T> out(6 * (model.joints.size() - 1), T(0));
    recursive::jointReactions(kept.model, kept.ws, out);
    return column(out);
  }
  bool isLumped() const {  ///< fixed joints are left out of `model`
    return std::any_of(model.joints.begin() + 1, model.joints.end(),
                       [](const auto& joint) { return joint.link < 0; });
  }
  std::vector<T> zeros() const { return std::vector<T>(model.dof(), T(0)); }

  recursive::Model<T> model;
  recursive::Workspace<T> ws;
  /// Where fixed joints are lumped in `model`: one with all of them, otherwise none.
  std::vector<Setup> with_fixed_joints;
};

struct NewtonEuler {
  static constexpr const char* kName = "newton_euler";
  static constexpr SolvedBy kSolvedBy = SolvedBy::kSweep;  ///< never asked
  static constexpr const char* kMethod =
      "outward sweep of motion, inward sweep of force (recursive Newton-Euler)";
  static bool answers(Quantity quantity) { return quantity != Quantity::kQdd; }

  template <typename T>
  static MatrixX<T> answer(Setup<T>& s, Quantity quantity, const scene::State<T>& state) {
    switch (quantity) {
      case Quantity::kM: {  // column j: the forces of a unit acceleration of joint j alone
        MatrixX<T> M(s.model.dof(), s.model.dof());
        for (int j = 0; j < s.model.dof(); ++j) {
          std::vector<T> unit = s.zeros();
          unit[j] = T(1);
          M.col(j) = s.inverse(state, s.zeros(), unit, Terms::none());
        }
        return M;
      }
      case Quantity::kc:
        return s.inverse(state, state.qd, s.zeros(), Terms::none());
      case Quantity::kg:
        return s.inverse(state, s.zeros(), s.zeros(), Terms::potential());
      case Quantity::kTau:
        return s.inverse(state, state.qd, state.qdd, Terms::all());
      case Quantity::kKinetic:
        return scalar(recursive::kineticEnergy(s.model, state.x, state.qd, s.ws));
      case Quantity::kPotential:
        return scalar(recursive::potentialEnergy(s.model, state.x, s.ws));
      case Quantity::kMomentum:
        return recursive::momentum(s.model, state.x, state.qd, s.ws).vector();
      case Quantity::kReactions:
        return s.reactions(state);
      case Quantity::kQdd:
        break;
    }
    throw std::logic_error("newton_euler: not answered");
  }
};

struct CompositeBody {
  static constexpr const char* kName = "composite_body";
  static constexpr SolvedBy kSolvedBy = SolvedBy::kMassMatrix;
  static constexpr const char* kMethod = "M by composite bodies; qdd from M = L D L'";
  static bool answers(Quantity quantity) {
    return quantity == Quantity::kM || quantity == Quantity::kQdd;
  }

  template <typename T>
  static MatrixX<T> answer(Setup<T>& s, Quantity quantity, const scene::State<T>& state) {
    MatrixX<T> M(s.model.dof(), s.model.dof());
    recursive::massMatrix(s.model, state.x, s.ws, M);
    if (quantity == Quantity::kM) return M;
    // M qdd = tau - (c + g - Q)
    MatrixX<T> qdd = column(state.tau) - s.inverse(state, state.qd, s.zeros(), Terms::all());
    recursive::factorize(M);
    Eigen::Ref<Eigen::Matrix<T, Eigen::Dynamic, 1>> b = qdd.col(0);
    recursive::solve(M, b);
    return qdd;
  }
};

struct ArticulatedBody {
  static constexpr const char* kName = "articulated_body";
  static constexpr SolvedBy kSolvedBy = SolvedBy::kSweep;
  static constexpr const char* kMethod = "articulated inertias, projected inward joint by joint";
  static bool answers(Quantity quantity) { return quantity == Quantity::kQdd; }

  template <typename T>
  static MatrixX<T> answer(Setup<T>& s, Quantity, const scene::State<T>& state) {
    std::vector<T> qdd(s.model.dof(), T(0));
    recursive::forwardDynamics(s.model, state.x, state.qd, state.tau, s.ws, qdd);
    return column(qdd);
  }
};

}  // namespace dynwitness::crosscheck
