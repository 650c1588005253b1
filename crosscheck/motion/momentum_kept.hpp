// SPDX-License-Identifier: GPL-3.0-or-later
// The momentum of a mechanism that nothing acts on from outside.
#pragma once

#include <optional>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Whether nothing acts on a tree from outside: no gravity, no loads, and what moves in the world
/// floats there. Then its momentum [N s] and its angular momentum about the world's origin [N m s]
/// keep their values.
bool keepsMomentum(const scene::Mechanism& mechanism);

/** How far that momentum is from where it started, over its largest part.
    @param end  (q, qd, work) of a later state of the scene's motion
    @return nothing where the motion does not keep it, or it is zero at the start */
std::optional<double> momentumMoved(const scene::Scene& scene, const std::vector<double>& end);

/// What rounding the state after each step may do to it, over its largest part: an eps a step and
/// rate. A step that keeps momentum by its formulas stays below that; an error that falls with the
/// step comes on top of it for others.
double roundingOfMomentum(const scene::Mechanism& mechanism, double steps);

}  // namespace dynwitness::crosscheck
