// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of linearized motion.
#pragma once

#include <algorithm>
#include <vector>

#include "crosscheck/laws/law.hpp"
#include "crosscheck/studies/linearization_model.hpp"

namespace dynwitness::crosscheck {

/// A tree at a state; the sweeps' derivatives, and those of 4 x 4 matrices by Lagrange's equations.
template <typename T>
class LinearizationAsked {
 public:
  using Scalar = T;
  using Matrix = recursive::MatrixX<T>;
  using Moving = Dual<T>;

  /// @param state  its qdd becomes what its tau makes
  template <typename Numbers>
  LinearizationAsked(const scene::Mechanism& mechanism, const Numbers& number,
                     scene::State<T> state)
      : sweeps(mechanism, number),
        state(std::move(state)),
        lagrange_(mechanism, DualNumbers<Numbers>(number)) {
    this->state.qdd = sweeps.forward(this->state);
  }

  /// d tau / d(q | qd) of Lagrange's equations.
  Matrix ofLagrange(MovedPart part) {
    Matrix out(sweeps.n(), sweeps.n());
    for (int k = 0; k < sweeps.n(); ++k) {
      const scene::State<Moving> at = sweeps.moved(state, part, k);
      const std::vector<Moving> tau = lagrange_.inverse(at.x, at.qd, at.qdd, {true, true, true});
      for (int i = 0; i < sweeps.n(); ++i) out(i, k) = tau[i].derivative;
    }
    return out;
  }
  /// The same state at rest, without acceleration.
  scene::State<T> still() const {
    scene::State<T> out = state;
    for (auto* part : {&out.qd, &out.qdd}) part->assign(part->size(), T(0));
    return out;
  }

  LinearizationModel<T> sweeps;
  scene::State<T> state;

 private:
  HomogeneousModel<Moving> lagrange_;
};

struct MovedPositions : Law {
  static constexpr LawWords kWords = {"acceleration by position", "M dqdd/dq = - dtau/dq", "A",
                                      "articulated_body", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(LinearizationAsked<T>& at) {
    return {at.sweeps.massMatrix(at.state) * at.sweeps.ofForward(at.state, MovedPart::kPosition),
            -at.ofLagrange(MovedPart::kPosition)};
  }
};

struct MovedRates : Law {
  static constexpr LawWords kWords = {"acceleration by rate", "M dqdd/dqd = - dtau/dqd", "A",
                                      "articulated_body", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(LinearizationAsked<T>& at) {
    return {at.sweeps.massMatrix(at.state) * at.sweeps.ofForward(at.state, MovedPart::kRate),
            -at.ofLagrange(MovedPart::kRate)};
  }
};

struct MovedForces : Law {
  static constexpr LawWords kWords = {"acceleration by force", "M dqdd/dtau = 1", "B",
                                      "articulated_body", "composite_body"};
  template <typename T>
  static TwoSides<T> sides(LinearizationAsked<T>& at) {
    const recursive::MatrixX<T> B = at.sweeps.ofForward(at.state, MovedPart::kForce);
    recursive::MatrixX<T> one = recursive::MatrixX<T>::Constant(B.rows(), B.cols(), T(0));
    for (Eigen::Index i = 0; i < B.rows(); ++i) one(i, i) = T(1);
    return {at.sweeps.massMatrix(at.state) * B, one};
  }
};

struct ForcesOfMovedPositions : Law {
  static constexpr LawWords kWords = {"joint forces by position", "dtau/dq = dtau/dq", "dtau/dq",
                                      "newton_euler", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(LinearizationAsked<T>& at) {
    return {at.sweeps.ofInverse(at.state, MovedPart::kPosition),
            at.ofLagrange(MovedPart::kPosition)};
  }
};

struct ForcesOfMovedRates : Law {
  static constexpr LawWords kWords = {"joint forces by rate", "dtau/dqd = dtau/dqd", "dtau/dqd",
                                      "newton_euler", "recursive_lagrange"};
  template <typename T>
  static TwoSides<T> sides(LinearizationAsked<T>& at) {
    return {at.sweeps.ofInverse(at.state, MovedPart::kRate), at.ofLagrange(MovedPart::kRate)};
  }
};

/// Weights and springs have a potential, whose second derivatives these are.
struct SymmetricStiffness : Law {
  static constexpr LawWords kWords = {"symmetric stiffness", "dg/dq = (dg/dq)'", "dg/dq",
                                      "newton_euler", ""};
  /// Wrenches need not have a potential, and quasi-velocities give no second derivatives.
  static bool appliesTo(const scene::Mechanism& mechanism) {
    return mechanism.wrenches.empty() &&
           std::all_of(mechanism.links.begin(), mechanism.links.end(), [](const scene::Link& link) {
             return scene::ratesArePositionDerivatives(link.joint.kind);
           });
  }
  template <typename T>
  static TwoSides<T> sides(LinearizationAsked<T>& at) {
    const recursive::MatrixX<T> K = at.sweeps.ofInverse(at.still(), MovedPart::kPosition);
    return {K, K.transpose()};
  }
};

using LinearizationLaws = Laws<MovedPositions, MovedRates, MovedForces, ForcesOfMovedPositions,
                               ForcesOfMovedRates, SymmetricStiffness>;

}  // namespace dynwitness::crosscheck
