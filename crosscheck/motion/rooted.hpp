// SPDX-License-Identifier: GPL-3.0-or-later
// A scene whose tree starts at another of its links: the same mechanism in other coordinates.
#pragma once

#include <string>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** The scene with this link as the one that its tree starts from. The link floats in the world, by
    seven positions and six rates; each joint between it and the former start is turned round:

        X_J(q)^-1 = X_-J(q):   a turn about, or a slide along, the opposite axis by the same q

    so that its q, rates, force, spring, rotor, friction and function of time stay as they are. A
    spherical joint turned round has the conjugate quaternion, and -R w as its rate. Where the
    former tree floats in the world by its first joint, that joint is the new start's now. Otherwise
    what rested in the world hangs on the tree, and a weld holds it there: six coordinates more, and
    six equations. Loads, closures, springs and constraints stay on their links; massless links on
    fixed joints put a placement together that one joint has no words for. The start is the same
    pose and motion, in doubles.

    @throws scene::InputError  there is no such link; it rests in the world; a joint on the way
      cannot be turned round (universal, planar, floating; one with a gyroscopic rotor, which would
      sit on its child); what rested in the world has no mass, or some other motion of the new tree
      moves no inertia in any state (a thin rod that now spins about itself): M would be singular */
scene::Scene rooted(const scene::Scene& scene, const std::string& link);

}  // namespace dynwitness::crosscheck
