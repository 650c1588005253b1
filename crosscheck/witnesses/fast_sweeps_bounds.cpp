// SPDX-License-Identifier: GPL-3.0-or-later
// The fast sweeps with running errors.
#include "crosscheck/witnesses/compiled_sweeps.hpp"
#include "crosscheck/witnesses/fast_sweeps.hpp"

namespace dynwitness::crosscheck {

template class FastSweeps<RunningError>;
template class FastSweeps<AdjointError>;

}  // namespace dynwitness::crosscheck
