// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanisms that nobody chose: seeded random trees, and campaigns of exact checks over them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "crosscheck/exact/exact.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/** A random tree: a pure function of (seed, index, max_joints), and a valid scene.

    It has 1 to max_joints moving joints, each number equally likely, and links on fixed joints beside
    them; every joint kind and placement convention, general axes and angles, rotors with gears,
    springs, gravity in any direction (or none), and loads in link and world axes. Inertias are those
    of a few point masses, so they are physical, down to rods and single points. All numbers are
    rational, or rational multiples of pi where they are angles.

    @param max_joints  at least 1
    @throws std::invalid_argument when max_joints < 1
    @see scene::writeSceneToml(), which makes a scene file of it */
scene::Scene randomScene(std::uint64_t seed, std::uint64_t index, int max_joints);

struct RandomCampaign {
  struct Failure {
    scene::Scene scene;
    std::vector<CheckResult> checks;  ///< those that do not agree
    std::vector<Finding> findings;    ///< who stands alone
  };
  int mechanisms = 0, joints = 0;     ///< how many were checked, and their moving joints together
  int checks = 0;                     ///< residuals that are zero, or are not
  int not_answerable = 0;
  double error_probability = 0;       ///< the largest of all checks
  std::vector<Failure> failures;
};

/** Checks `count` random mechanisms exactly, each with exactChecks() at the options' seed. Witnesses are
    those that the options name; when they name none, all but kernels, whose making takes ten times as
    long as all other checks together.
    @param processes  how many of this processor's cores to use
    @param progress   called as mechanisms are done, with the number of those done; may be empty */
RandomCampaign crosscheckRandom(int count, int max_joints, const ExactOptions& options,
                                int processes = 1, const std::function<void(int)>& progress = {});

/// For people: what failed, and the command and the scene file that show it again.
std::string describeFailure(const RandomCampaign::Failure& failure);

}  // namespace dynwitness::crosscheck
