// SPDX-License-Identifier: GPL-3.0-or-later
// The bodies of an MJCF file with their joints: the links of a scene. For the reader of MJCF
// (mjcf_*.cpp) alone.
#pragma once

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "scene/arrange.hpp"
#include "scene/mjcf_orientations.hpp"
#include "scene/mjcf_settings.hpp"
#include "scene/work.hpp"

namespace dynwitness::scene::mjcf {

/// What a file says and no scene holds.
struct LeftOut {
  std::vector<std::string> lines;       ///< for people
  std::map<std::string, int> elements;  ///< their kinds, with how many
};

struct MovingJoint {
  std::string name;
  JointKind kind;
  Number ref;
};

/// Where a body is found among the links.
struct Place {
  std::string link;
  Vector shift;  ///< of the link's frame from the body's
  Pose pose;     ///< of the body
};

struct Bodies {
  std::vector<NamedLink> links;
  std::vector<MovingJoint> moving;  ///< in the order of MuJoCo's, which is the scene's
  std::unordered_map<std::string, std::size_t> moving_index;
  std::map<std::string, std::vector<Number>> free_starts;  ///< by joint
  std::map<std::string, Place> places;                     ///< by body
  bool has_limits = false;
};

/// @param top   <mujoco>
/// @param work  one unit a link
Bodies readBodies(const Node& top, const Compiler& compiler, const Defaults& defaults, Work* work,
                  LeftOut* left_out);

}  // namespace dynwitness::scene::mjcf
