// SPDX-License-Identifier: GPL-3.0-or-later
// What the chapter is about, at any joint of any scene: transformations, inertias, projections,
// bias forces.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/motion/joint_axes.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** Of a joint, with the link that it moves, in the axes of the moved joint frame (or others,
    joint_axes.hpp) about its origin (where reactions are, too), linear part first; a joint of
    several axes is one joint.
      X      6 x 6: motions in the frame of the parent's joint (the world's) to motions in this one
      M_i    6 x 6: inertia of the link
      M_C    6 x 6: composite, of all that hangs on the joint, joints locked
      M_A    6 x 6: articulated, joints outboard free
      P, PM  6 x 6: what passes of force and of M_A to the parent through the free joint, P times
             M_A but for gyroscopic rotors, whose pull is in PM (recursive/projection.hpp)
      Z      6 x axes
      F, PF  6: f_A, so that f = M_A a + F is what the link with all outboard needs: bias forces,
             loads, and what joint forces outboard come to; without gravity, which is the world's
             acceleration -g; and P F
      E      6 x m: what the link feels of unit forces of the m acceleration constraints
      beta   m: the rest of A' a = E' a_i + beta, of constraints outboard (or here), nu = 0; a
             constraint that is elsewhere has 0 */
enum class JointQuantity { kX, kM_i, kM_C, kM_A, kP, kPM, kZ, kF, kPF, kE, kBeta };
const char* name(JointQuantity quantity);
std::optional<JointQuantity> jointQuantityNamed(const std::string& name);

/// Joint by joint, all of one state from one pass of the sweeps: O(n) a state.
class JointQuantities {
 public:
  /// @param joints  by name, in this order; none: all, in the order of links
  /// @throws scene::InputError  no such joint; what Command::kEvaluateJoints refuses
  JointQuantities(const scene::Scene& scene, const std::vector<std::string>& joints,
                  JointAxes axes = JointAxes::kLink);
  ~JointQuantities();

  /// "elbow.M_A11", ..., "elbow.F_fx", "elbow.Z_vx" ("hip.Z2_vx" of several axes), "elbow.E1_fx",
  /// "elbow.beta1", in the order of value(). @throws scene::InputError  E or beta without
  /// acceleration constraints; Z of joints that are all fixed
  std::vector<std::string> columns(JointQuantity quantity) const;
  /// Their units, "kg m^2"; "1" where there is none.
  std::vector<std::string> units(JointQuantity quantity) const;

  /// @param state  tau may be missing: then F, PF and beta are those without joint forces
  void at(const scene::State<double>& state);
  /// Of the state, row by row, one column of columns() an entry.
  Eigen::VectorXd value(JointQuantity quantity) const;

  JointAxes axes() const;
  /// The links that the joints move, by index of the scene's.
  std::vector<std::size_t> links() const;
  /// In the order of value(), what somebody else says of the joints at the state: `of` the k-th of
  /// links(), row by row, in the axes of its moved frame.
  Eigen::VectorXd arranged(JointQuantity quantity,
                           const std::function<Eigen::MatrixXd(std::size_t)>& of) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
