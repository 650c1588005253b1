// SPDX-License-Identifier: GPL-3.0-or-later
// A and B in letters, by Lagrange's equations: of which scenes, and do the sweeps say the same?
#pragma once

#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "scene/scene.hpp"
#include "symbolic/linear_system.hpp"

namespace dynwitness::crosscheck {

/// @throws scene::InputError  no letters of this scene: it is no tree of few free joints
void requireLetters(const scene::Scene& scene);

/** Over the field, for every value of the parameters and of what of the state is a letter:

      - M^-1 K = dqdd/dq,  - M^-1 D = dqdd/dqd,  M^-1 = dqdd/dtau

    left by the graph of Lagrange's equations, right by dual numbers in the articulated-body sweep
    at the forces that make qdd what the state says. What is printed of the graph is held to it by
    symbolic::readBack. */
std::vector<CheckResult> checkLettersExactly(const scene::Scene& scene,
                                             const symbolic::LinearSystem& letters,
                                             ExactOptions options = {});

}  // namespace dynwitness::crosscheck
