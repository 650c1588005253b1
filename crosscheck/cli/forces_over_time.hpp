// SPDX-License-Identifier: GPL-3.0-or-later
// Joint forces over time that a user gives: functions of t, or a file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::cli {

/// Adds joint forces at time t [s] to tau [N m, N], one a rate.
using ForcesOverTime = std::function<void(double, std::vector<double>*)>;

/// --tau: functions of t, of all joints in their order or by name, "elbow=2*sin(3*t)".
/// @throws scene::InputError  no such joint, one that is driven, or no function of t
ForcesOverTime forcesOfTime(const std::vector<std::string>& words, const scene::Scene& scene);
/// --forces: rows of a file (t or time_s, and tau1..), straight lines between them.
/// @throws scene::InputError  columns are missing, times fall or do not span 0 to duration [s]
ForcesOverTime forcesOfFile(const std::string& file, const scene::Scene& scene, double duration);

}  // namespace dynwitness::cli
