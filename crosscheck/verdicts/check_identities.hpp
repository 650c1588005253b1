// SPDX-License-Identifier: GPL-3.0-or-later
// The laws of mechanics on our own sweeps.
#pragma once

#include <vector>

#include "crosscheck/verdicts/options.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/prepared_scene.hpp"

namespace dynwitness::crosscheck {

/// The laws of identities.hpp on our own sweeps, and that M is positive definite.
std::vector<CheckResult> checkIdentities(const PreparedScene& scene, const Options& options);

}  // namespace dynwitness::crosscheck
