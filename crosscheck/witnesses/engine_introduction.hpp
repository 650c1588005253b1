// SPDX-License-Identifier: GPL-3.0-or-later
// What an engine says of itself in answer to the greeting. For the protocol of engines
// (engine_*.cpp) alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "crosscheck/witnesses/engine_words.hpp"
#include "crosscheck/witnesses/outside_claims.hpp"
#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck::engine {

/// What an engine believes a link to be, by the link's name.
struct ToldLink {
  std::string name;
  BelievedLink link;
};

/// The scene's links of these names. @throws std::runtime_error  there is none, or it comes twice
std::vector<BelievedLink> believedLinks(const std::vector<ToldLink>& told,
                                        const scene::Mechanism& mechanism);

/// What an engine answers to the greeting.
struct Introduction {
  std::string name, version, refuses;
  std::vector<std::string> quantities, joints;
  std::optional<std::vector<ToldLink>> model;
  bool wxyz = true;  ///< false: quaternions come as (x, y, z, w)

  /// @throws std::runtime_error  what was expected, and what came
  explicit Introduction(const Json& said);
};

/** Where the engine keeps our slots: theirs[i] = ours[of[i]]. A joint's slots stay together, in
    their order but for those of a quaternion. */
struct Order {
  std::vector<int> positions, rates;
  bool is_ours = true;

  /// @throws std::runtime_error  its joints are not those of the scene
  Order(const scene::Mechanism& mechanism, const Introduction& engine);
};

}  // namespace dynwitness::crosscheck::engine
