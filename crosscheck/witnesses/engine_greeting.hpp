// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine may be asked: the greeting says so, and its answer is held to it. For the protocol
// of engines (engine_*.cpp) alone.
#pragma once

#include <string>
#include <vector>

#include "crosscheck/witnesses/witness.hpp"

namespace dynwitness::crosscheck::engine {

/// Of a state.
inline constexpr Quantity kAskable[] = {
    Quantity::kM,         Quantity::kc,        Quantity::kg,
    Quantity::kTau,       Quantity::kQdd,      Quantity::kKinetic,
    Quantity::kPotential, Quantity::kMomentum, Quantity::kReactions};
inline constexpr const char* kModel = "model";  ///< which the handshake holds

/// All of a state, and the Jacobian of a frame.
std::vector<std::string> askable();

}  // namespace dynwitness::crosscheck::engine
