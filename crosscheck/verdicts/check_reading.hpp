// SPDX-License-Identifier: GPL-3.0-or-later
// The reading of the scene's file, which all witnesses share, held to a second one (rereading/).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "crosscheck/rereading/description.hpp"
#include "crosscheck/scalars/running_error.hpp"
#include "crosscheck/verdicts/result.hpp"
#include "crosscheck/witnesses/prepared_scene.hpp"

namespace dynwitness::recursive {
template <typename T>
struct Model;
}  // namespace dynwitness::recursive

namespace dynwitness::crosscheck {

/// The name of these checks, and how reports call who stands against the scene in them.
inline constexpr const char *kReading = "reading", *kRereading = "rereading";
WitnessInfo rereadingInfo(const std::string& version);

/** Whether the scene is what its file says, by a second road from the text to where the links
    are and what they weigh. Three checks of the law "reading":

        placements   frames of all links in the world, at q = 0 and at a seeded state, and of the
                     ends of closures and springs on their links
        masses       mass, first moment and inertia about the origin of each link that moves, in its
                     axes, with what fixed joints hold to it
        numbers      gravity, rotors, friction, springs, followers, loads, constraints, the start

    Limits are the rounding of the scene's own road in double, proven by running errors, the
    rounding of the 50 digits of the other one, and u for telling them in double.

    What the second road does not look at is a check of its own, left out with its name: so is the
    whole where there is no file, or no such road for its format.
    @param engines  witnesses that read the file themselves: told in the first check */
std::vector<CheckResult> checkReading(const PreparedScene& scene, std::uint64_t seed,
                                      const std::vector<std::string>& engines = {});

/// The same against a description that is there already.
/// @param model  of the scene, fixed joints lumped
std::vector<CheckResult> compareReading(const scene::Scene& scene,
                                        const recursive::Model<RunningError>& model,
                                        const rereading::Description& file, std::uint64_t seed,
                                        const std::vector<std::string>& engines = {});

/// Of a check of placements: who read the file itself, "no engine reads this file, ..."; else "".
std::string whoReads(const CheckResult& check);

/// What stands against the scene, as findings.
std::vector<Finding> findReadingFaults(const std::string& scene_name,
                                       const std::vector<CheckResult>& checks);

}  // namespace dynwitness::crosscheck
