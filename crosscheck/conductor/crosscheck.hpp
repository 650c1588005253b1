// SPDX-License-Identifier: GPL-3.0-or-later
// The crosscheck: witnesses against each other, identities, tables and energy, one scene at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// Everything about one scene, derivation and drift included.
SceneResult crosscheckScene(const PreparedScene& scene, const std::vector<WitnessKind>& kinds,
                            const Options& options);

/** The same for several scenes, in several processes: whole scenes where there are as many as
    processes, and parts of scenes where there are fewer.
    @param done  called with a scene's index when it is done; may be empty */
std::vector<SceneResult> crosscheckScenes(const std::vector<scene::Scene>& scenes,
                                          const std::vector<WitnessKind>& kinds,
                                          const Options& options, int processes,
                                          const std::function<void(int)>& done = {});

}  // namespace dynwitness::crosscheck
