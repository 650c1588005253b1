// SPDX-License-Identifier: GPL-3.0-or-later
// All about a scene's inertial parameters: what `dynwitness parameters` finds out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/parameters/base_parameters.hpp"
#include "crosscheck/parameters/uncertainty.hpp"

namespace dynwitness::crosscheck {

struct ParametersOptions {
  int states = 20;  ///< seeded states of the stacked Y and of the uncertainty
  std::uint64_t seed = 1;
  double error_probability = 1e-30;  ///< of the rank
  std::string uncertainty;           ///< readUncertainty(); empty: none
  int samples = 10000;               ///< Monte Carlo draws
  double chance = 1e-9;              ///< that draws of a right covariance are called wrong
};

/// First-order deviations of tau against draws, all errors of the geometry `scale` times as large.
struct GeometryRow {
  double scale;
  CovarianceCheck check;
};

/// Of M_A and P of one joint: root mean squares of the sums of squares in each block of three by
/// three, which no turn of the axes changes.
struct JointDeviation {
  std::string joint;
  double M_A[3];  ///< masses [kg], first moments [kg m], inertias [kg m^2]
  double P[4];    ///< force of force [1], of moment [1/m], moment of force [m], of moment [1]
};

struct UncertaintyResult {
  Uncertainty given;
  Eigen::VectorXd by_inertia, by_geometry, tau;  ///< root mean squares over the states [N m, N]
  Deviations of_qdd;                             ///< the same of accelerations [rad/s^2, m/s^2]
  Eigen::VectorXd qdd;
  std::vector<JointDeviation> joints;      ///< none of scenes that evaluate refuses M_A of
  bool follows = false;                    ///< accelerationsFollowForces()
  std::optional<CovarianceCheck> inertia;  ///< draws at state 0, where inertias are uncertain
  std::vector<GeometryRow> geometry;       ///< the same where placements are, by size
};

struct ParametersResult {
  scene::Scene scene;
  ParametersOptions options;
  BaseParameters base;
  std::vector<double> values;  ///< pi
  int energy_rank = 0;
  std::optional<int> closed_form;  ///< mayedaCount()
  /// Largest over smallest singular value of Y_1 stacked over the states: as it is in SI units, and
  /// with each column divided by its length, which no unit changes. Nothing: fewer rows than
  /// columns, or singular values that double precision does not tell from 0.
  std::optional<double> condition, scaled_condition;
  std::optional<UncertaintyResult> uncertainty;

  /// pi_1 + K pi_2 of one base parameter.
  double baseValue(int row) const;
  /// Both ranks and the closed form are the same, and draws at the smallest errors fit the first
  /// order.
  bool agrees() const;
};

/// @throws scene::InputError  no joint moves, or the uncertainty cannot be read
ParametersResult examineParameters(const scene::Scene& scene, const ParametersOptions& options);

}  // namespace dynwitness::crosscheck
