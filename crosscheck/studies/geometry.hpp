// SPDX-License-Identifier: GPL-3.0-or-later
// Differential geometry of a scene's motion: metric, connection, curvature, and their laws.
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

/** What closures leave of the configuration space near a position: a surface. */
struct Surface {
  std::vector<double> q, qd;        ///< on it, one a position slot; along it
  std::vector<int> rows;            ///< equations of the closures that stand for all
  std::vector<int> rates;           ///< independent ones; of a tree all
  std::vector<int> dependent;       ///< the others
  bool has_dependent_rows = false;  ///< closures that depend on each other there
};
/// The surface through the closed position next to q; of a tree all that there is.
/// @param qd  velocity, the nearest along the surface is taken; empty: none
/// @throws scene::InputError  another number of positions, or no small change of q and qd closes
///   the closures
Surface surfaceNear(const scene::Scene& scene, const std::vector<double>& q,
                    const std::vector<double>& qd = {});

/** The kinetic metric at one position, with running error bounds, on the frame E_a of the
    independent rates: rate a is 1, the other independent ones are 0, and closures say what the rest
    does. Of a tree E_a is e_a. */
struct MetricAt {
  Surface surface;
  Bounded M;                           ///< f x f [kg m^2, kg m, kg]
  std::vector<Bounded> first, second;  ///< by a: <E_a, D_b E_c> and E_a's share in D_b E_c, f x f
  Bounded sectional;                   ///< f x f: plane of E_a and E_b [1/(kg m^2)]; diagonal 0
  bool commutes = true;                ///< no joint is spherical or floating
};
/// @param q  position, one a slot
/// @throws scene::InputError  as surfaceNear(), or too many joints
MetricAt metricAt(const scene::Scene& scene, const std::vector<double>& q);

/** The laws of the metric, decided over the field for every state, M by composite bodies and its
    derivatives by duals:
      Gamma_i,jk qd_j qd_k = c           by Newton-Euler (trees)
      Gamma_i,jk qd_j = C_ik             by composite bodies (trees)
      qdd = -Gamma(qd, qd)               is the motion without forces, by articulated bodies
      R(u, v, u, v)                      from M alone = from outside, by Gauss's equation: the robot
                                         is a surface in the flat space of all its points (4 x 4
                                         matrices)
      D2J/dt2 = -R(J, qd) qd             is the derivative of that motion along J (Jacobi)
      R_ijkl + R_jkil + R_kijl = 0       (Bianchi)
    Of closed mechanisms on every surface on which phi is constant, loops eliminated where they
    close. Closures that depend on each other where they hold do so nowhere else: there the field
    does not answer. */
std::vector<CheckResult> checkGeometryExactly(const scene::Scene& scene,
                                              const ExactOptions& options);

}  // namespace dynwitness::crosscheck
