// SPDX-License-Identifier: GPL-3.0-or-later
// How uncertain joint forces are when the numbers of a scene are.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/motion/uncertain_quantities.hpp"
#include "scene/inertial_parameters.hpp"
#include "scene/scene.hpp"
#include "scene/state.hpp"

namespace dynwitness::crosscheck {

/// J F for placements, with J = dtau/d(errors) by dual numbers [n x errors].
Eigen::MatrixXd placementEffect(const scene::Mechanism& mechanism,
                                const scene::State<double>& state, const Uncertainty& uncertainty);

/// Y at one state, in double. [n x p]
Eigen::MatrixXd regressorAt(const scene::Mechanism& mechanism,
                            const std::vector<scene::InertialParameter>& parameters,
                            const scene::State<double>& state);

/** Whether, at a random point of a prime field, changes of qdd at given tau (by dual numbers
    through the articulated-body sweep) are those of tau at given qdd: for every inertial parameter
    and every error of a placement,

        M d qdd + d tau = 0

    with M by composite bodies and d tau by the regressor, or by dual numbers through Newton's and
    Euler's sweep. */
bool accelerationsFollowForces(const scene::Scene& scene, std::uint64_t seed);

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
