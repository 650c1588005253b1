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

struct Projector : Law {
  static constexpr LawWords kWords = {"projector", "P P = P - M Z D^-1 d D^-1 Z' with D = d + Z'MZ",
                                      "P", "articulated_body", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using Matrix6 = recursive::Matrix6<T>;
    return {stacked(at.passedJoints(), [](const auto& j) -> Matrix6 { return j.P * j.P; }),
            stacked(at.passedJoints(), [](const auto& j) -> Matrix6 {
              return j.P - Matrix6(j.M_Z * j.weight * j.Z.transpose());
            })};
  }
};

struct SymmetricProjectedInertia : Law {
  static constexpr LawWords kWords = {"projected inertia is symmetric", "P M = (P M)'", "P M",
                                      "articulated_body", ""};
  template <typename T>
  static TwoSides<T> sides(SweptMechanism<T>& at) {
    using Matrix6 = recursive::Matrix6<T>;
    return {stacked(at.passedJoints(), [](const auto& j) -> Matrix6 { return j.P_M; }),
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
                    [](const auto& j) -> Matrix6 {
                      return j.P_M * recursive::accelerationProjection(j.M, j.Z, j.d);
                    }),
            stacked(at.passedJoints(), [](const auto& j) -> Matrix6 {
              return j.P_M - Matrix6(j.M_Z * j.weight * j.M_Z.transpose());
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
      sides.right.middleRows(j.dof, j.axes) = j.leak * j.Z.transpose();
    }
    return sides;
  }
};

}  // namespace dynwitness::crosscheck
