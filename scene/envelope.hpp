// SPDX-License-Identifier: GPL-3.0-or-later
// The ranges of q, qd and qdd, and of tau, that a scene's file gives: what a motion of it may be.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::scene {

struct Range {
  double low = 0, high = 0;

  double most() const { return high > -low ? high : -low; }  ///< the largest |x|
};

/// Of one rate; SI units.
struct JointRanges {
  Range q, qd, qdd;
  std::optional<Range> tau = std::nullopt;  ///< what drives it; none: not given
};

/** The table [envelope] of a scene's TOML text, one entry a rate in the order of qd; none: the text
    has no such table. Bounds are the doubles nearest to what is written.
    @throws InputError  a joint that is not there or has no range, a key that is none, a range that
      is empty or not finite */
std::vector<JointRanges> envelopeOf(const std::string& text, const Scene& scene);

/// The same of the scene's own file; none where that is no TOML.
/// @throws InputError  as envelopeOf(); the file cannot be read any more
std::vector<JointRanges> readEnvelope(const Scene& scene);

/// The table as TOML, to stand at the end of a scene; none: no text. What is read back is the same.
std::string writeEnvelope(const Scene& scene, const std::vector<JointRanges>& ranges);

/// Whether the scene's own file has the table.
/// @throws InputError  the file cannot be read any more
bool hasEnvelope(const Scene& scene);

}  // namespace dynwitness::scene
