// SPDX-License-Identifier: GPL-3.0-or-later
// MuJoCo's own file format, for joints that a URDF cannot say.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/// What the bodies and joints of mjcf() are called: no name of a scene is taken, by MuJoCo or XML.
std::string mjcfLink(int link);
std::string mjcfJoint(int link);       ///< the first of a body's joints
std::string mjcfJointFrame(int link);  ///< of a free joint alone: a body fixed to the parent

/** A tree as MJCF without <compiler> and <size>: a body a link, in which the joints of the scene's
    one stand in the order of its rates,

        revolute, prismatic    hinge, slide
        cylindrical            slide, hinge
        universal              hinge about x, hinge about y
        planar                 slide along x, along y, hinge
        spherical              ball
        floating  free, where the parent rests in the world (such a body must be a child
                               of MuJoCo's world); otherwise slides along x, y, z, ball

    Frames are formed in long double and printed with the 17 digits of a double.
    @param inertials  an <inertial> element a link, or ""
    @throws std::runtime_error  a joint is helical */
std::string mjcf(const scene::Mechanism& mechanism, const std::vector<std::string>& inertials);

/// Numbers with 17 digits, and a blank between.
std::string mjcfNumbers(const std::vector<double>& numbers);

}  // namespace dynwitness::crosscheck
