// SPDX-License-Identifier: GPL-3.0-or-later
// How uncertain joint forces are when the numbers of a scene are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

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

/// The same for placements: J F, with J = dtau/d(errors) by dual numbers [n x errors].
Eigen::MatrixXd placementEffect(const scene::Mechanism& mechanism,
                                const scene::State<double>& state, const Uncertainty& uncertainty);

/// Y at one state, in double. [n x p]
Eigen::MatrixXd regressorAt(const scene::Mechanism& mechanism,
                            const std::vector<scene::InertialParameter>& parameters,
                            const scene::State<double>& state);

/** Covariance of tau over `samples` draws: the whole sweep, on a model with every number changed.
    Draw k is a pure function of (seed, k), so that sizes of errors are compared on the same draws.
    */
Eigen::MatrixXd sampledByInertia(const scene::Mechanism& mechanism,
                                 const scene::State<double>& state, const Eigen::MatrixXd& factor,
                                 int samples, std::uint64_t seed);
Eigen::MatrixXd sampledByGeometry(const scene::Mechanism& mechanism,
                                  const scene::State<double>& state, const Uncertainty& uncertainty,
                                  int samples, std::uint64_t seed);

/** Whether a sample covariance S of N normal draws can be one of Sigma. For any u fixed beforehand,
    (N - 1) u'S u / u'Sigma u is chi-square with N - 1 degrees of freedom (S is Wishart). Asked for
    u = e_i and e_i + e_j, which is every entry of Sigma; the two-sided quantiles share `chance`
    between all of them, so that a right Sigma is called wrong at most that often. */
struct CovarianceCheck {
  double low, high;    ///< quantiles of sqrt(u'Su / u'Sigma u)
  double least, most;  ///< that were found; 1 where there is nothing uncertain
  bool agrees() const { return low <= least && most <= high; }
};
CovarianceCheck compareCovariance(const Eigen::MatrixXd& Sigma, const Eigen::MatrixXd& sampled,
                                  int samples, double chance);

}  // namespace dynwitness::crosscheck
