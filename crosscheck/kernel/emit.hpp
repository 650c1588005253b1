// SPDX-License-Identifier: GPL-3.0-or-later
// Programs as C that a compiler makes fast: one state, or several in the lanes of vector registers.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/kernel/roads.hpp"
#include "recursive/fast/sine_cosine.hpp"
#include "symbolic/program.hpp"

namespace dynwitness::crosscheck::kernel {

/** A C translation unit (GNU C vector types, <math.h>) with, for a formula called NAME,

        void NAME(const double* q, const double* u, const double* w, double* out);
        void NAME_many(const double* q, const double* u, const double* w, double* out, long count);

    u: qd, w: qdd or tau; what the formula does not read may be null. NAME_many takes `count`
    states, a component after the other: component i of state k is at [i * count + k].

    cos and sin are computed here, for `lanes` numbers at once: by Taylor's series after a reduction
    to |r| <= pi/4 with pi/2 in three parts, each within 1 ulp, for angles up to kLargestAngle;
    beyond that the C library's are called, lane by lane. Every other operation is one operation of
    the program, in its order, so that with -ffp-contract=off the results are those of
    symbolic::ProgramRun<double>, bit for bit.

    The same program gives the same bytes.
    @param run    the program with its numbers
    @param lanes  doubles in a vector: 2, 4 or 8 */
std::string emitKernel(const symbolic::Program& program, const symbolic::ProgramRun<double>& run,
                       const std::string& name, int lanes);

using recursive::fast::kLargestAngle;

/// The text of recursive/fast/sine_cosine.inc, which the build puts here.
extern const char* const kSineCosine;

}  // namespace dynwitness::crosscheck::kernel
