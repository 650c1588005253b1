// SPDX-License-Identifier: GPL-3.0-or-later
// Friction for engines that have none, or not ours: applied at their boundary.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "crosscheck/witnesses/witness.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {

/// The scene's friction as generalized forces, for an engine that computes without it (or without
/// Coulomb's part).
class JointFriction {
 public:
  enum class Parts { kAll, kCoulomb };
  explicit JointFriction(const scene::Mechanism& mechanism, Parts parts = Parts::kAll) {
    const scene::RealNumbers<double> number(mechanism);
    for (const scene::Link& link : mechanism.links) {
      const scene::Friction& f = link.joint.friction;
      for (int k = 0; k < scene::degreesOfFreedom(link.joint.kind); ++k)
        joints_.push_back(
            {parts == Parts::kAll ? number(f.viscous) : 0, number(f.positive), number(f.negative)});
    }
  }

  /// The engine's value(state) with friction: it adds to tau, and for qdd is taken off tau before.
  template <typename Value>
  Eigen::MatrixXd around(Quantity quantity, const scene::State<double>& state, Value value) const {
    if (quantity == Quantity::kTau) {
      Eigen::MatrixXd tau = value(state);
      for (Eigen::Index i = 0; i < tau.rows(); ++i) tau(i, 0) += force(i, state.qd[i]);
      return tau;
    }
    if (quantity != Quantity::kQdd) return value(state);
    scene::State<double> left = state;
    for (std::size_t i = 0; i < left.tau.size(); ++i) left.tau[i] -= force(i, state.qd[i]);
    return value(left);
  }

 private:
  struct Joint {
    double viscous, positive, negative;
  };
  double force(std::size_t i, double qd) const {
    const Joint& joint = joints_[i];
    return joint.viscous * qd + (qd > 0 ? joint.positive : qd < 0 ? -joint.negative : 0);
  }

  std::vector<Joint> joints_;  ///< one a degree of freedom
};

/// @throws std::runtime_error, which becomes the witness's answer, when a rotor is gyroscopic
inline void requirePlainRotors(const scene::Mechanism& mechanism) {
  for (const scene::Link& link : mechanism.links)
    if (link.joint.gyroscopic)
      throw std::runtime_error(
          "the rotor of joint '" + link.joint.name +
          "' is gyroscopic, this witness knows a rotor as inertia n^2 J of its "
          "own joint only");
}

}  // namespace dynwitness::crosscheck
