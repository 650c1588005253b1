// SPDX-License-Identifier: GPL-3.0-or-later
// dynwitness simulate --plot: one motion by several methods.
#pragma once

#include <filesystem>
#include <string>

#include "crosscheck/motion/formulations.hpp"
#include "crosscheck/report/plot.hpp"
#include "scene/scene.hpp"

namespace dynwitness::cli {

/// "method,time_s,energy_error_J,q_apart", a line an output: |E - E0 - work|, and the largest
/// difference of q from the reference [rad, m, 1]. Quaternions have the sign of the reference's.
std::string motionsCsv(const scene::Scene& scene,
                       const crosscheck::FormulationComparison& comparison);

/** Energy errors against time, and below them how far each method's positions are from the
    reference, logarithmic, a line a method.
    @throws std::runtime_error  nothing above zero is there to be drawn, or gnuplot fails */
void drawMotions(const scene::Scene& scene, const crosscheck::FormulationComparison& comparison,
                 const std::filesystem::path& file, const crosscheck::PictureLook& look);

}  // namespace dynwitness::cli
