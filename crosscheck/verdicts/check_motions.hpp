// SPDX-License-Identifier: GPL-3.0-or-later
// The verdict on motions that are published, or that another road of our own knows.
#pragma once

#include <vector>

#include "crosscheck/motion/motion_tables.hpp"
#include "crosscheck/verdicts/result.hpp"

namespace dynwitness::crosscheck {

/// Moves what the table moves (simulate(), with the error of a step that the table asks for) and
/// compares all its values; a few seconds at most for the bundled ones.
PublishedMotion reenacted(const MotionTable& table, const scene::Scene& reported_in);

/// All that stand in the report of this scene.
/// @throws scene::InputError  a table that cannot be read
std::vector<PublishedMotion> publishedMotions(const scene::Scene& scene);

/// Agrees when every value lies within its limit; a motion that cannot be simulated disagrees.
CheckResult checkMotion(const PublishedMotion& motion);

}  // namespace dynwitness::crosscheck
