// SPDX-License-Identifier: GPL-3.0-or-later
// What a report says of a scene before anything is checked.
#pragma once

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Name, title, source, links and joints, and what of the scene a crosscheck leaves out.
void describe(const scene::Scene& scene, const Options& options, SceneResult& result);

/// T, V, M, c and g as maths where they are short enough to read, and their size.
Equations equationsOf(const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
