// SPDX-License-Identifier: GPL-3.0-or-later
// The witnesses that witnessKinds() lists, one source file each.
#pragma once

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

WitnessKind lagrangeKind();         ///< symbolic/: derived from T and V, run as a program
WitnessKind newtonEulerKind();      ///< recursive/: outward motion, inward force
WitnessKind compositeBodyKind();    ///< recursive/: M by composite bodies, M qdd = tau - c - g
WitnessKind articulatedBodyKind();  ///< recursive/: articulated inertias
WitnessKind fastKind();             ///< recursive/fast/: the same three algorithms, made for speed
WitnessKind recursiveLagrangeKind();  ///< Lagrange's equations link by link, 4 x 4 matrices
WitnessKind kernelKind();             ///< the scene's own compiled program, one state at a time
WitnessKind kernelLanesKind();        ///< the same on several states at once
WitnessKind simbodyKind();            ///< Simbody, which reads the scene with its own transforms

/** qdd [n] of the closed mechanism by Simbody's own constraints (Rod, PointOnLine, Ball,
    ConstantAngle, Weld) and springs, at a state with phi = 0 and J qd = 0 and with its tau.
    @throws std::invalid_argument  the scene has rotors */
Eigen::VectorXd simbodyClosedAccelerations(const scene::Scene& scene,
                                           const scene::State<double>& state);

// optional: present where crosscheck/cmake/engines.cmake found the engine
WitnessKind mujocoKind();           ///< MuJoCo, from URDF or, for joints it cannot say, MJCF
WitnessKind mujocoPrincipalKind();  ///< the same, given inertias in their principal axes
WitnessKind dartKind();             ///< DART, from URDF; other joints are exchanged for its own
WitnessKind kdlKind();              ///< Orocos KDL, built from its own joints, segments and frames

}  // namespace dynwitness::crosscheck
