// SPDX-License-Identifier: GPL-3.0-or-later
// Work-precision diagrams of whole simulations: data, and a gnuplot script that draws them.
#pragma once

#include <string>

#include "crosscheck/motion/work_precision.hpp"

namespace dynwitness::crosscheck {

/// `method,order,observed_order,step_s,rhs_calls,cpu_s,error,energy_error,end`, the last "reached"
/// or why there is no end, under `#` lines with reference and machine.
std::string workCsv(const WorkPrecision& work);

/** Draws NAME.svg from NAME.csv beside it.
    @param style  the path of style.gp, as seen from the script's folder */
std::string workScript(const WorkPrecision& work, const std::string& name,
                       const std::string& style);

/// The one a method has in every chart, in gnuplot's words: "linetype 3 pointtype 9".
std::string lookOfMethod(const std::string& method);

/// "runge_kutta_fehlberg78 and gauss_6 ... agree to 14 places; with the elliptic functions to 15"
std::string referenceText(const ReferenceMotion& reference);

}  // namespace dynwitness::crosscheck
