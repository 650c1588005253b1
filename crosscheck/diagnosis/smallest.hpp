// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest question that a witness still answers wrongly.
#pragma once

#include <optional>

#include "crosscheck/diagnosis/exhibits.hpp"

namespace dynwitness::crosscheck {

/** Cuts links off that nothing hangs on, one after the other, as long as the witness, made anew for
    what is left, is still wrong; then brings rates, accelerations, forces and positions to rest,
    one after the other. A witness that does not hold what is left is no longer wrong. */
std::optional<Smallest> smallestFailure(const scene::Scene& scene, const WitnessKind& kind,
                                        Quantity quantity, const scene::State<double>& state,
                                        double factor);

}  // namespace dynwitness::crosscheck
