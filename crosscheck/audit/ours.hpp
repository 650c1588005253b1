// SPDX-License-Identifier: GPL-3.0-or-later
// What the files of recursive/ answer, held to the truth of point masses and dense equations. A
// fault found here is ours and decides no sentence of the chapter.
#pragma once

#include <string>

#include "crosscheck/audit/robot.hpp"

namespace dynwitness::audit {

/// Section 5: forces, velocities and momenta between frames, by our transformations.
Trial ourTransformations();
/// Section 6: the force of a body in motion, its inertia about another point and in other axes.
Trial ourBodies();
/// Section 7: qdd, M_A, P and P M that a sweep leaves, and P of any inertia about any axis.
Trial ourProjections(Rotors rotors);
/// Section 8: Xd, Xdd and M_A of a chain of two links.
Trial ourChain();
/// Section 9: tau of a motion and qdd of a tau.
Trial ourAlgorithms();
/// Section 11: qdd, N and the unit forces E under a constraint.
Trial ourConstraints();
/// Sections 12 and 13: the dynamically consistent inverse.
Trial ourConsistentInverse();
/// Section 14: M by composite bodies.
Trial ourMassMatrix();
/// Section 15: T and V.
Trial ourEnergies();

/// The comparison for an entry that names this file of recursive/ and has none of its own; none for
/// other files.
Trial oursOf(const std::string& file);

}  // namespace dynwitness::audit
