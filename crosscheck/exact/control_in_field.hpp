// SPDX-License-Identifier: GPL-3.0-or-later
// The run's own control over the prime field.
#pragma once

#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "crosscheck/verdicts/control.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// The control over the prime field, against Newton-Euler and articulated bodies: by "field".
std::vector<Control> controlInField(const scene::Scene& scene, const ExactOptions& options);

}  // namespace dynwitness::crosscheck
