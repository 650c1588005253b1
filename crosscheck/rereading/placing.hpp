// SPDX-License-Identifier: GPL-3.0-or-later
// Where the links of a description are, and what they weigh: homogeneous 4 x 4 matrices, each as it
// is printed in textbooks, with 50 digits.
#pragma once

#include <array>
#include <vector>

#include "crosscheck/rereading/description.hpp"

namespace dynwitness::crosscheck::rereading {

using Column = std::array<Real, 3>;
using Square = std::array<Column, 3>;  ///< rows

/** A frame on another one, x_outer = R x_inner + p: the matrix [R p; 0 1]. Of rounding and of what
    it was made of, R is off by at most `turned` (in the 2-norm, and so in each entry), p by `moved`
    [m]. */
struct Frame {
  Square R = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Column p = {0, 0, 0};
  double turned = 0, moved = 0;

  friend Frame operator*(const Frame& a, const Frame& b);
};

/// Moved by xyz, then turned: R = Rz(yaw) Ry(pitch) Rx(roll), as one matrix.
Frame movedAndTurned(const Vector& xyz, const Vector& rpy);
/// On its link.
Frame frameOf(const Anchor& anchor);

/// How many positions a joint of this kind has. @throws std::runtime_error  there is no such kind
int positionCount(const std::string& kind);
/// Of all links, followers among them.
int positionCount(const Description& description);

/// The frames of all links in the world.
/// @param q  the positions of all joints in their order; those of followers are not used
std::vector<Frame> placed(const Description& description, const std::vector<double>& q);

/** A body in a frame, as its pseudo-inertia matrix: the sum over its points of mass times x x', x
    homogeneous,

        J = [ S   h ]     S = sum m r r' [kg m^2], h = sum m r [kg m];   I = tr(S) 1 - S
            [ h'  m ]

    In another frame it is X J X', X = [R p; 0 1]: turns and parallel axes in one product. */
struct PseudoInertia {
  Square S = {};
  Column h = {0, 0, 0};
  Real mass = 0;
  double error_S = 0, error_h = 0, error_mass = 0;

  void add(const PseudoInertia& other);
  PseudoInertia seenFrom(const Frame& frame) const;  ///< in the frame that `frame` stands on
  Square inertia() const;                            ///< about the frame's origin [kg m^2]
  double errorOfInertia() const;
};

PseudoInertia pseudoInertia(const Solid& solid);

/// A link with all that fixed joints hold to it, in the link's frame.
struct Body {
  int link;
  PseudoInertia inertia;
};
/// One a link that moves on its parent, and the root.
std::vector<Body> weighed(const Description& description);

}  // namespace dynwitness::crosscheck::rereading
