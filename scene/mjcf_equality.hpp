// SPDX-License-Identifier: GPL-3.0-or-later
// What <equality> of an MJCF file holds together: closures of the scene and joints that follow
// others. For the reader of MJCF (mjcf_*.cpp) alone.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "scene/mjcf_bodies.hpp"

namespace dynwitness::scene::mjcf {

/// A closure, with its links by name.
struct Closing {
  Closure closure;
  std::string a, b;
};

struct Equalities {
  std::vector<Closing> closings;
  std::unordered_map<std::string, Mimic> follows;  ///< by the follower's joint
};

void readEquality(const Node& node, const Bodies& bodies, const Defaults& defaults, Equalities* out,
                  LeftOut* left_out);

}  // namespace dynwitness::scene::mjcf
