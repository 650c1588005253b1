// SPDX-License-Identifier: GPL-3.0-or-later
// The crosscheck: witnesses against each other, identities, tables and energy, one scene at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/arithmetic/indeterminates.hpp"
#include "crosscheck/result.hpp"
#include "crosscheck/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

struct Options {
  std::uint64_t seed = 1;
  int states = 100;
  std::vector<std::string> witnesses;  ///< names to ask; empty: all that are present
  bool drift = true;                   ///< simulate 10 s and watch the energy
  double error_probability = 1e-30;  ///< chance at most that an exact check passes a wrong formula
  Parameters parameters = Parameters::kAsWritten;  ///< in exact checks: the scene's, or any
};

/// The kinds that the options ask for. @throws scene::InputError on a name that does not exist or
/// is absent from this build.
std::vector<WitnessKind> selectWitnesses(const std::vector<std::string>& names);

/// Each quantity, each pair of witnesses that answer it, at the options' states: |left - right|
/// must lie within the sum of both sides' error bounds.
std::vector<CheckResult> compareWitnesses(const scene::Scene& scene,
                                          const std::vector<WitnessKind>& kinds,
                                          const Options& options);

/// Who stands alone: for each quantity in dispute, the witness that disagrees with all others while
/// these agree.
std::vector<Finding> findOutliers(const std::string& scene_name,
                                  const std::vector<CheckResult>& checks);

/// The laws of identities.hpp on our own sweeps, and that M is positive definite.
std::vector<CheckResult> checkIdentities(const scene::Scene& scene, const Options& options);

/// @throws scene::InputError when no joint of the scene moves: nothing can be asked about it then
void requireMotion(const scene::Scene& scene);

/// Everything about one scene, derivation and drift included.
SceneResult crosscheckScene(const scene::Scene& scene, const std::vector<WitnessKind>& kinds,
                            const Options& options);

/** The same for several scenes, in several processes: whole scenes where there are as many as
    processes, and parts of scenes where there are fewer.
    @param done  called with a scene's index when it is done; may be empty */
std::vector<SceneResult> crosscheckScenes(const std::vector<scene::Scene>& scenes,
                                          const std::vector<WitnessKind>& kinds,
                                          const Options& options, int processes,
                                          const std::function<void(int)>& done = {});

}  // namespace dynwitness::crosscheck
