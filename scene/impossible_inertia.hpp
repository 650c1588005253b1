// SPDX-License-Identifier: GPL-3.0-or-later
// Inertias that no body has: by how much, what they may have been meant as, and which is nearest.
#pragma once

#include <array>
#include <string>

#include "scene/mechanism.hpp"
#include "scene/rational_geometry.hpp"

namespace dynwitness::scene {

/// What a link's author wrote, in the axes that its inertia is given in.
struct WrittenInertia {
  const MassProperties& written;  ///< for the digits as printed
  RationalMatrix given;           ///< the six numbers
  RationalMatrix shift;           ///< m (c.c 1 - c c'): the parallel axis theorem's part
  Rational mass;
  Rational allowance;  ///< what an irrational turn may leave

  bool aboutOrigin() const { return written.about == MassProperties::About::kLinkOrigin; }
  /// About the centre of mass, when the six numbers are `numbers`.
  RationalMatrix aboutCenterOfMass(const RationalMatrix& numbers) const;
};

/** Its principal moments, which rule they break and by how much:
    "principal moments of inertia about the centre of mass are 1, 1, 3 kg m^2, which breaks the
    triangle inequality, allowed: none greater than the sum of the other two: by 1 kg m^2 (33 %)".
    Empty: some body has it. */
std::string impossibility(const WrittenInertia& inertia);

/** What the numbers may have been meant as, found by trying: each reason named makes the inertia
    one that a body has. Digits cut off; six times the same number; products of the other sign or in
    another unit; the six numbers in another order; the parallel axis theorem applied once too
    often, or not; a decimal point. And the unit in which the body would be of the robot's size.
    @param size  of the robot: the longest lever of the file [m]; 0: not known
    @return  "digits cut off; ...", empty: none was found */
std::string likelyReason(const WrittenInertia& inertia, double size);

/** The nearest inertia that a body has, mass and centre of mass as they are: that of the pseudo-
    inertia matrix nearest in the Frobenius norm among the positive semidefinite ones. About the
    centre of mass that matrix is diag(S, m) with S = tr(I)/2 1 - I, and its nearest has the
    negative eigenvalues of S replaced by zero:  I = tr(S) 1 - S.
    @param I  (xx, yy, zz, xy, xz, yz) about the centre of mass [kg m^2] */
std::array<double, 6> nearestPossible(const std::array<double, 6>& I);

}  // namespace dynwitness::scene
