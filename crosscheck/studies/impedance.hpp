// SPDX-License-Identifier: GPL-3.0-or-later
// Stiffness, damping, compliance and inertia of a point of a link, seen from the joints and back.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/studies/geometry.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct ImpedanceOptions {
  std::vector<double> q;       ///< empty: the scene's start
  std::string link;            ///< empty: the last link
  std::array<double, 3> at{};  ///< the point, in the link's frame [m]
  std::array<double, 6> stiffness{1, 1, 1,
                                  0, 0, 0};         ///< along and about world axes [N/m], [N m/rad]
  std::array<double, 6> damping{1, 1, 1, 0, 0, 0};  ///< [N s/m], [N m s/rad]
  std::array<double, 3> stretch{};  ///< how far the spring along the axes is stretched already [m]
  std::vector<double> joint_compliance;  ///< n [rad/(N m), m/N]; empty: 1 each
};

/// Matrices with running error bounds; x is the point's motion in world axes, linear part first.
struct ImpedanceAt {
  Bounded J;           ///< 6 x n
  Bounded stiffness;   ///< J' K J, n x n
  Bounded geometric;   ///< (dJ'/dq) f of the stretched spring, n x n
  Bounded damping;     ///< J' D J
  Bounded compliance;  ///< J C_q J', 6 x 6
  Bounded mobility;    ///< J M^-1 J', 6 x 6: the inverse of the apparent inertia, of any rank
  Bounded inertia;     ///< (J M^-1 J')^-1 of the point alone, 3 x 3; bounds are infinite where the
                       ///< point cannot move every way
  std::vector<CheckResult> checks;
};
ImpedanceAt impedanceAt(const scene::Scene& scene, const ImpedanceOptions& options);

/** The laws of impedances, over the field for every state, point and stiffness:
      d2V/dq2 = J' K J + (dJ'/dq) f             V = (x - x_0)' K (x - x_0) / 2, f = K (x - x_0):
                                                places by 4 x 4 matrices, differentiated twice by
                                                nested duals
      w' C_x w = dq' K_q dq                     C_x = J C_q J', dq: what a wrench w does to q
      qd' D_q qd = xd' D xd                     xd by 4 x 4 matrices
      (J M^-1 J') f                             is the point's acceleration by articulated bodies
      T(Jbar xd) = xd' (J M^-1 J')^-1 xd / 2    Jbar the dynamically consistent inverse
      J^-T (J' K J) J^-1 = K                    where J is square
      t' K t and trace(C M)                     stay when another frame is chosen:
                                                K_f = X^-T K X^-1, C_f = X C X' */
std::vector<CheckResult> checkImpedanceExactly(const scene::Scene& scene, const std::string& link,
                                               const ExactOptions& options);

}  // namespace dynwitness::crosscheck
