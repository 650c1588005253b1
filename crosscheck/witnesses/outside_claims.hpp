// SPDX-License-Identifier: GPL-3.0-or-later
// What a program or an engine may say besides quantities of a state.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/witnesses/frame_jacobian.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// The word for the Jacobian of a frame: in the protocol, in what `check` says, in rubrics.
inline constexpr const char* kJacobian = "jacobian";

/// What a program believes a link of the scene to be: in the axes of the scene's link frame, com
/// from its origin, inertia about com.
struct BelievedLink {
  int link = -1;  ///< of the scene
  double mass = 0;
  Eigen::Vector3d com = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

/// Those of a witness that may make them; it may make either, both or none.
class OutsideClaims {
 public:
  virtual ~OutsideClaims() = default;

  /// Its links, each at most once. Nothing: it does not say.
  virtual std::optional<std::vector<BelievedLink>> believedLinks() const { return std::nullopt; }

  struct SaidJacobian {
    Eigen::MatrixXd value;  ///< as FrameJacobian has it
    std::string reason;     ///< why there is none
  };
  virtual bool knowsJacobian() const = 0;
  /// One a state. @throws std::runtime_error  it has failed
  virtual std::vector<SaidJacobian> jacobians(const FramePoint& point,
                                              const std::vector<scene::State<double>>& states) = 0;
};

}  // namespace dynwitness::crosscheck
