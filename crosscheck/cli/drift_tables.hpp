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
    @param files    CSV of t, q, qd, qdd; none: none
    @param options  without engines its steps are those that the files' motions were made with, one
                    a file; none: what is between their rows
    @param convention  whose coordinates spherical and floating joints have in them; "": they say so
    @param energy   gets |E - E0| along the files' motions as far as all of them go, steps falling,
                    and the order between the two finest; without paths: no files
    @return 1 where a model is wrong */
int judgeMotions(const scene::Scene& scene, const std::vector<std::string>& engines,
                 const std::vector<std::string>& files, const crosscheck::DriftOptions& options,
                 const std::string& convention, crosscheck::Drift* energy);

}  // namespace dynwitness::cli
