// SPDX-License-Identifier: GPL-3.0-or-later
// How uncertain forces, accelerations and what passes through joints are when a scene's numbers
// are.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/motion/joint_quantities.hpp"
#include "scene/inertial_parameters.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/** Standard deviations of independent, normally distributed errors. */
struct Uncertainty {
  double mass = 0;  ///< of each link, relative: its density, so m, h and I grow together
  double com = 0;   ///< of each centre of mass, along each axis [m]: h by m times that
  double inertia =
      0;  ///< of each of the six numbers of I, as a share of the largest moment about the
          ///< centre of mass
  double rotor = 0;  ///< of each rotor inertia, relative
  double xyz = 0;    ///< of each joint's place, along each axis [m]
  double rpy = 0;    ///< of each joint's orientation, about each axis [rad]

  bool ofInertia() const { return mass > 0 || com > 0 || inertia > 0 || rotor > 0; }
  bool ofGeometry() const { return xyz > 0 || rpy > 0; }
};

/// Reads "mass=0.05,com=0.002,rpy=0.001". @throws scene::InputError naming what was read, what is
/// allowed
Uncertainty readUncertainty(const std::string& text);

/** F with Sigma_pi = F F': the effect on pi of each independent error of size one deviation. */
Eigen::MatrixXd parameterFactor(const scene::Mechanism& mechanism,
                                const std::vector<scene::InertialParameter>& parameters,
                                const Uncertainty& uncertainty);

/// Standard deviations of first order, entry by entry: of the errors of inertias and of those of
/// placements.
struct Deviations {
  Eigen::VectorXd by_inertia, by_placement;
  Eigen::VectorXd together() const;
};

/** Deviations of what a tree answers, all its joints free, by derivatives that are exact (dual
    numbers through the sweeps): the squares of the changes by each error of one deviation, summed.
    Friction, springs and loads are what the scene says. tau is at the state's qdd, all others at
    its tau. */
class UncertainQuantities {
 public:
  /// @param of  whose joints and axes joints() is about, outlives this; none: it is not asked
  /// @throws scene::InputError  misplaced joints and the world's axes, which do not go with the
  /// link that an error turns
  UncertainQuantities(const scene::Scene& scene, const Uncertainty& given,
                      const JointQuantities* of = nullptr);
  ~UncertainQuantities();

  Deviations tau(const scene::State<double>& state) const;
  Deviations qdd(const scene::State<double>& state) const;
  /// In the order of JointQuantities::columns(), in their units. @throws scene::InputError  E, beta
  Deviations joints(JointQuantity quantity, const scene::State<double>& state) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace dynwitness::crosscheck
