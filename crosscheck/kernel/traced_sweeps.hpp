// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps of recursive/, written down as they run.
#pragma once

#include <vector>

#include "crosscheck/kernel/lean_sweeps.hpp"
#include "crosscheck/kernel/roads.hpp"

namespace dynwitness::crosscheck::kernel {

/// The outputs of a formula by the sweeps of recursive/: Newton-Euler, composite bodies for M,
/// articulated bodies for forward dynamics.
std::vector<Traced> tracedSweep(const recursive::Model<Traced>& model, Formula formula,
                                const scene::State<Traced>& state);

/// A lean model as those sweeps read it.
recursive::Model<Traced> recursiveModel(const LeanModel& lean);

}  // namespace dynwitness::crosscheck::kernel
