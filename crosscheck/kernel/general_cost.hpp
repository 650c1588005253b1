// SPDX-License-Identifier: GPL-3.0-or-later
// What a mechanism costs without a kernel of its own.
#pragma once

#include "crosscheck/kernel/roads.hpp"

namespace dynwitness::crosscheck::kernel {

/** Operations of the sweeps of recursive/fast/, made for any mechanism: multiplications, additions
    and divisions, counted as they run (sines and cosines are free, as in Road::operations()).
    @param formula  ID, M or FD. @throws std::invalid_argument for another */
long generalOperations(const scene::Mechanism& mechanism, Formula formula);

/// The same of d tau/d(q, qd, qdd), or of d qdd/d(q, qd, tau) with qdd on the way.
long generalDerivativeOperations(const scene::Mechanism& mechanism, bool of_accelerations);

/// Of one angle's sine and cosine, counted in the text that sweeps and kernels share
/// (recursive/fast/sine_cosine.inc); what chooses among quarters is none.
long sineCosineOperations();

}  // namespace dynwitness::crosscheck::kernel
