// SPDX-License-Identifier: GPL-3.0-or-later
// Mass, centre of mass and inertia of a body, as moments of its mass: so that bodies add up.
#pragma once

#include "scene/mechanism.hpp"
#include "symbolic/frames.hpp"
#include "symbolic/numbers.hpp"
#include "symbolic/vectors.hpp"

namespace dynwitness::symbolic {

/// The moments of a body's mass about the origin of a frame, in that frame's axes: m [kg],
/// integral of r dm [kg m], and the inertia integral of (r'r 1 - r r') dm [kg m^2].
struct MassMoments {
  Value mass;
  Vector3 first;
  Symmetric second;
};

MassMoments noMass(Graph* graph);
MassMoments operator+(const MassMoments& a, const MassMoments& b);

/// From the frame that the steps lead to, to the one that they start from.
MassMoments movedBack(const FrameStep& step, const MassMoments& b);
MassMoments movedBack(const FrameSteps& steps, MassMoments b);

/// Those of a link, about the origin of its frame.
MassMoments linkMoments(const scene::MassProperties& inertia, NodeNumbers& number);

}  // namespace dynwitness::symbolic
