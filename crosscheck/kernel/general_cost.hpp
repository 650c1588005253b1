// SPDX-License-Identifier: GPL-3.0-or-later
// What a mechanism costs without a kernel of its own.
#pragma once

#include "crosscheck/kernel/roads.hpp"

namespace dynwitness::crosscheck::kernel {

/** Operations of the sweeps of recursive/fast/, made for any mechanism: multiplications, additions
    and divisions, counted as they run (sines and cosines are free, as in Road::operations()).
    @param formula  ID, M or FD. @throws std::invalid_argument for another */
long generalOperations(const scene::Mechanism& mechanism, Formula formula);

}  // namespace dynwitness::crosscheck::kernel
