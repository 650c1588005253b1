// SPDX-License-Identifier: GPL-3.0-or-later
// What is said about joints that an envelope holds.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/scene.hpp"

namespace dynwitness::cli {

/// On standard error, as what a command leaves out is; none held: nothing.
/// @param scene  in which they are fixed
inline void tellHeldJoints(const std::vector<std::string>& held, const scene::Scene& scene) {
  if (held.empty()) return;
  fmt::print(
      stderr,
      "{}: [envelope] holds {} joints at 0, which are fixed here: {}; tau_1 to tau_{} are of "
      "{}\n",
      scene.name, held.size(), fmt::join(held, ", "), scene.mechanism.dof(),
      fmt::join(scene.mechanism.rateLabels(), ", "));
}

}  // namespace dynwitness::cli
