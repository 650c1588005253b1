// SPDX-License-Identifier: GPL-3.0-or-later
// What `evaluate` answers about closures, driven joints, constraints on accelerations, and tasks.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// By the sweeps (loops eliminated where they close, hybrid dynamics), or by one dense system:
/// closures together with driven joints or acceleration constraints have the latter only.
enum class ConstrainedRoad { kSweeps, kDense };

/** Motion and forces of a scene with closures (m_c equations), driven joints (d) and acceleration
    constraints (m):

        M qdd + c + g = tau + Q + springs + J_c' lambda + J' nu
        J_c qdd + gamma = 0,    J qdd + (dJ/dt) qd + C nu = value,     qdd of driven joints given */
struct ConstrainedMotion {
  Eigen::VectorXd qdd, lambda, nu;  ///< n, m_c, m
  Eigen::VectorXd tau;              ///< n: as given, and what the drives take
  std::vector<bool> lambda_determined, nu_determined;
  int rank = 0, rows = 0;  ///< of all equations together
};

/** Beside motion and forces, of the acceleration constraints as tasks: N (their accelerations by
    unit forces, without compliance), Lambda = N^-1 (task inertia), J, Jbar (dynamically consistent
    inverse), task_torque (of the controller, the state's tau its posture), null_torque
    ((1 - J' Jbar') tau). And reactions, 6 a joint of the tree (constrainedReactions()): those that
    redundant constraints leave open are not a number (nan). */
enum class ConstrainedQuantity {
  kQdd,
  kLambda,
  kNu,
  kTauDrive,  ///< forces of driven joints
  kN,
  kTaskInertia,
  kJ,
  kJbar,
  kTaskTorque,
  kNullTorque,
  kReactions
};
/// "qdd", "lambda", "nu", "tau_drive", "N", "Lambda", "J", "Jbar", "task_torque", "null_torque",
/// "reactions"
const char* name(ConstrainedQuantity quantity);
std::optional<ConstrainedQuantity> constrainedQuantityNamed(const std::string& name);

class ConstrainedQuantities {
 public:
  explicit ConstrainedQuantities(const scene::Scene& scene);
  ~ConstrainedQuantities();

  /// Whether the scene has closures, springs between points, driven joints or acceleration
  /// constraints.
  static bool isConstrained(const scene::Mechanism& mechanism);
  /// @throws std::invalid_argument  the sweeps are asked for what only the dense system has
  ConstrainedMotion motion(const scene::State<double>& state, ConstrainedRoad road) const;
  /// Which road motion() can go.
  ConstrainedRoad usualRoad() const;

  /// Row by row. @throws scene::InputError  the scene has not what is asked about, or redundant
  /// tasks
  Eigen::MatrixXd answer(ConstrainedQuantity quantity, const scene::State<double>& state) const;

  /// The state of the scene's start at t = 0, driven joints with their accelerations.
  scene::State<double> start() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
