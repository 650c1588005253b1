// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness drift --advise, --engine-steps and --motion.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/motion/drift.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

/** Prints, method by method, the largest stable step and the step for an accuracy of the end.
    @param methods  empty: all that know the scene */
int adviseSteps(const scene::Scene& scene, std::vector<std::string> methods, double duration,
                double accuracy);

/** Prints for each motion whether the model is wrong, and how far its steps are off.
    @param engines  that move the scene themselves, from its start, with one step of the options
    @param file     CSV of t, q, qd, qdd; "": none
    @param convention  whose coordinates spherical and floating joints have in it; "": it says so
    @return 1 where a model is wrong */
int judgeMotions(const scene::Scene& scene, const std::vector<std::string>& engines,
                 const std::string& file, const crosscheck::DriftOptions& options,
                 const std::string& convention = {});

}  // namespace dynwitness::cli
