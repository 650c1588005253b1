// SPDX-License-Identifier: GPL-3.0-or-later
// What our sweeps answer in float, with a bound on what rounding made of it.
#pragma once

#include <functional>
#include <string>

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck {

using SingleSweep = std::function<Answer(Quantity, const scene::State<double>&)>;

/** The sweep that the witness of this name runs, in float and with proven bounds: of the answer to
    the state as it is told in double, whose rounding to float counts.
    @param witness  newton_euler, composite_body or articulated_body; of others: empty
    The returned function throws what the sweep throws. */
SingleSweep sweepInSinglePrecision(const std::string& witness, const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck
