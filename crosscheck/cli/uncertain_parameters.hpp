// SPDX-License-Identifier: GPL-3.0-or-later
// [envelope.parameters] of a scene as the command line gives it.
#pragma once

#include <vector>

#include "crosscheck/cli/door.hpp"
#include "scene/uncertain_parameters.hpp"

namespace dynwitness::cli {

/// Of its file, for the scene as it is read: shares are of the values that it has now.
inline std::vector<scene::UncertainParameter> uncertainParametersOf(const GivenScene& given,
                                                                    const scene::Scene& scene) {
  return scene::readUncertainParameters(
      given.isAsWritten() ? scene.file
                          : scene::findScene(given.name, scene::InertiaNeed::kOfNoJoint).file,
      scene);
}

}  // namespace dynwitness::cli
