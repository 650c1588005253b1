// SPDX-License-Identifier: GPL-3.0-or-later
// States of few digits at which exact checks are asked.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "crosscheck/scalars/prime_field.hpp"
#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {

/** A state in whole numbers, SI units.
    A joint that follows another has no entry of its own in positions: its leader decides. */
struct SmallState {
  /// One a slot: the component of a quaternion (of any length) [1], a slide [m], and of a turn the
  /// tangent t of half its angle, so that cos and sin, (1 - t^2)/(1 + t^2) and 2 t/(1 + t^2), are
  /// rational.
  std::vector<int> positions;
  std::vector<int> qd, qdd, tau;  ///< one a rate
};

/// Puts it in place of indeterminates. The angle itself, which springs and screws measure, stays
/// one where it is not 0: no tangent but 0 has a rational angle.
void putInto(const SmallState& small, const scene::Mechanism& mechanism, const FieldNumbers& number,
             scene::State<PrimeField>& state);

/// q at it, slot by slot, as scene files write numbers: "0", "pi/2", "pi-asin(3/5)". Followers have
/// "0".
std::vector<scene::Number> positionsOf(const SmallState& small, const scene::Mechanism& mechanism);

struct FoundState {
  SmallState state;
  int trials = 0;
};

/** The state of few digits that still `shows` it: numbers from 1 to 9, else up to 99, up to 999, of
    which as many as can be become 0 or 1. The same questions and answers give the same state.
    @param shows  what it throws counts as no
    @return nothing where none of the states that were tried shows it */
std::optional<FoundState> smallestState(const scene::Mechanism& mechanism, std::uint64_t seed,
                                        const std::function<bool(const SmallState&)>& shows);

}  // namespace dynwitness::crosscheck
