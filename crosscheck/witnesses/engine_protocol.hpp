// SPDX-License-Identifier: GPL-3.0-or-later
// Any program can testify: it reads questions as lines of JSON and answers them
// (engine_protocol.md).
#pragma once

#include <string>
#include <vector>

#include "crosscheck/system/children.hpp"
#include "crosscheck/witnesses/witness.hpp"
#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

inline constexpr int kEngineProtocol = 1;        ///< its version
inline constexpr std::size_t kEngineBatch = 64;  ///< most states of one question

/** One kind a command. Each program is asked for its name once, with this scene, and is started
    again for every scene that it testifies about.

    @return  named as the programs name themselves, or engine_1, engine_2, ... where they do not, or
             where the name is taken. A program that fails is a kind, too: its witnesses say why. */
std::vector<WitnessKind> engineKinds(const std::vector<std::string>& commands, const Limits& limits,
                                     const scene::Scene& scene);

/// Whether a kind is one of these: its time passes in another process.
bool isProgram(const WitnessKind& kind);

/// Lets a witness of such a kind answer these states in batches; value() then has this quantity at
/// hand, and of no states before. What goes wrong, value() says. Others are left alone.
void askEngineAhead(Witness& witness, Quantity quantity,
                    const std::vector<scene::State<double>>& states);

/// The same in two steps, so that a batch (kEngineBatch states at most) is under way while the
/// answers to the one before are used: the first sends it, the second has the answers to the oldest
/// at hand, and no others. Not more than two at a time: what two pipes hold.
void sendEngineAhead(Witness& witness, Quantity quantity,
                     const std::vector<scene::State<double>>& states);
void receiveEngineAhead(Witness& witness);

/// The first line that an engine is sent: protocol, what may be asked, and the scene.
std::string greetingOf(const scene::Scene& scene);

}  // namespace dynwitness::crosscheck
