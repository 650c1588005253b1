// SPDX-License-Identifier: GPL-3.0-or-later
// Differential geometry of a scene's motion: metric, Christoffel symbols, curvature, and their
// laws.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/scalars/bounded.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// The kinetic metric at one position, with running error bounds.
struct MetricAt {
  Bounded M;                           ///< [kg m^2, kg m, kg]
  std::vector<Bounded> first, second;  ///< by i: Gamma_i,jk and Gamma^i_jk as n x n
  Bounded sectional;                   ///< n x n: plane of q_i and q_j [1/(kg m^2)]; diagonal 0
};
/// @param q  position, one a joint
/// @throws scene::InputError  what Command::kGeometry refuses, another number of joints
MetricAt metricAt(const scene::Scene& scene, const std::vector<double>& q);

/** The laws of the metric, decided over the field for every state, M by composite bodies and its
    derivatives by duals:
      Gamma_i,jk qd_j qd_k = c           by Newton-Euler
      Gamma_i,jk qd_k = C_ij             by composite bodies
      qdd = -Gamma(qd, qd)               is the motion without forces, by articulated bodies
      R(u, v, u, v)                      from M alone = from outside, by Gauss's equation: the robot
                                         is a surface in the flat space of all its points (4 x 4
                                         matrices)
      D2J/dt2 = -R(J, qd) qd             is the derivative of that motion along J (Jacobi)
      R_ijkl + R_jkil + R_kijl = 0       (Bianchi) */
std::vector<CheckResult> checkGeometryExactly(const scene::Scene& scene,
                                              const ExactOptions& options);

}  // namespace dynwitness::crosscheck
