// SPDX-License-Identifier: GPL-3.0-or-later
// What is said about joints that an envelope holds.
#pragma once

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crosscheck/cli/standard_files.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

/// A remark, as of what a command leaves out; none held: nothing.
/// @param scene  in which they are fixed
inline void tellHeldJoints(const std::vector<std::string>& held, const scene::Scene& scene) {
  if (held.empty()) return;
  tell(fmt::format(
      "{}: [envelope] holds {} joints at 0, which are fixed here: {}; tau_1 to tau_{} are of {}\n",
      scene.name, held.size(), fmt::join(held, ", "), scene.mechanism.dof(),
      fmt::join(scene.mechanism.rateLabels(), ", ")));
}

}  // namespace dynwitness::cli
