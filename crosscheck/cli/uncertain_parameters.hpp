// SPDX-License-Identifier: GPL-3.0-or-later
// [envelope.parameters] of a scene as the command line gives it.
#pragma once

#include <vector>

#include <fmt/format.h>

#include "crosscheck/cli/door.hpp"
#include "crosscheck/cli/standard_files.hpp"
#include "scene/uncertain_parameters.hpp"

namespace dynwitness::cli {

/// Of its file, for the scene as it is read: shares are of the values that it has now.
inline std::vector<scene::UncertainParameter> uncertainParametersOf(const GivenScene& given,
                                                                    const scene::Scene& scene) {
  return scene::readUncertainParameters(fileOf(given, scene), scene);
}

/// Where a command takes them at the values that they have, whatever else they may be.
inline void tellNominalParameters(const GivenScene& given, const scene::Scene& scene) {
  if (scene::hasUncertainParameters(fileOf(given, scene), scene))
    tell(fmt::format(
        "{}: [envelope.parameters] is left out: what is proven holds for the numbers as "
        "they are, not for others that these may be\n",
        scene.name));
}

}  // namespace dynwitness::cli
