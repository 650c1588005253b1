// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of section 7 of the chapter, at every moving joint, one below the other.
#pragma once

#include <vector>

#include "crosscheck/laws/swept_mechanism.hpp"

namespace dynwitness::crosscheck {

/// Six rows a joint.
template <typename T, typename AtOne>
recursive::MatrixX<T> stacked(const std::vector<PassedJoint<T>>& joints, const AtOne& at_one) {
  recursive::MatrixX<T> out(6 * static_cast<Eigen::Index>(joints.size()), 6);
  Eigen::Index row = 0;
  for (const PassedJoint<T>& joint : joints) {
    out.middleRows(row, 6) = at_one(joint);
    row += 6;
  }
  return out;
}

/* P is what the steps of the articulated-body sweep make of unit forces, P M what they make of the
   articulated inertia: rank-one losses, axis by axis. The other sides are matrices of M, Z and d.
   A gyroscopic rotor that a link carries has G = (0, h z) and, as articulated_step.hpp says,

       U = M Z + G,   D = d + Z'MZ,   P = 1 - U D^-1 Z',   passed on is  M - U D^-1 U'

   so that the chapter's laws, which know G = 0, get the terms below. */

struct Projector : Law {
  static constexpr LawWords kWords = {
      "projector", "P P = P - M Z D^-1 d D^-1 Z' with D = d + Z'MZ, P as the sweep passes forces",
      "P", "articulated_body", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using Matrix6 = recursive::Matrix6<T>;
    return {stacked(at.passedJoints(), [](const auto& j) -> Matrix6 { return j.P * j.P; }),
            stacked(at.passedJoints(), [](const auto& j) -> Matrix6 {
              return j.P - Matrix6(j.U * j.inverse_D * j.leak * j.inverse_D * j.Z.transpose());
            })};
  }
};

struct SymmetricProjectedInertia : Law {
  static constexpr LawWords kWords = {
      "projected inertia is symmetric",
      "P M = (P M)': as the sweep passes forces, and as it passes inertia", "P M",
      "articulated_body", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using Matrix6 = recursive::Matrix6<T>;
    return {stacked(at.passedJoints(),
                    [](const auto& j) -> Matrix6 {
                      return Matrix6(j.P * j.M) - Matrix6(j.U * j.inverse_D * j.G.transpose());
                    }),
            stacked(at.passedJoints(), [](const auto& j) -> Matrix6 { return j.P_M.transpose(); })};
  }
};

struct ProjectedTwice : Law {
  static constexpr LawWords kWords = {"projected twice", "P M P' = P M - M Z D^-1 d D^-1 Z' M",
                                      "P M P'", "articulated_body", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using Matrix6 = recursive::Matrix6<T>;
    return {stacked(at.passedJoints(),
                    [](const auto& j) -> Matrix6 { return j.P * j.M * j.P.transpose(); }),
            stacked(at.passedJoints(), [](const auto& j) -> Matrix6 {
              const Matrix6 spin = j.U * j.inverse_D * j.G.transpose();
              return j.P_M + spin + Matrix6(spin.transpose()) -
                     Matrix6(j.U * j.inverse_D * j.d * j.inverse_D * j.U.transpose());
            })};
  }
};

struct DualProjections : Law {
  static constexpr LawWords kWords = {"projections of force and motion are dual",
                                      "Z' P F = d D^-1 Z' F for every F", "Z' P",
                                      "articulated_body", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using recursive::MatrixX;
    const int n = at.letGo().dof();
    TwoSides<T> sides = {MatrixX<T>::Constant(n, 6, T(0)), MatrixX<T>::Constant(n, 6, T(0))};
    for (const PassedJoint<T>& j : at.passedJoints()) {
      sides.left.middleRows(j.dof, j.axes) = j.Z.transpose() * j.P;
      sides.right.middleRows(j.dof, j.axes) = j.leak * j.inverse_D * j.Z.transpose();
    }
    return sides;
  }
};

}  // namespace dynwitness::crosscheck
