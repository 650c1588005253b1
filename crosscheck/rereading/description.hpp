// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene's file says, read a second time.
//
// Nothing here includes a file of this project outside of this folder, scene/ not either
// (tests/project/test_independence.cpp): what is shared with the readers of scenes are the parsers
// of TOML and XML, and the formats as they are documented.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "crosscheck/rereading/value.hpp"

namespace dynwitness::crosscheck::rereading {

/// A joint that follows another one: q = multiplier q_leader + offset.
struct Following {
  std::string leader;
  Value multiplier = 1, offset;
};

/// A rotor geared to all rates of a joint; with an axis it is gyroscopic.
struct GearedRotor {
  Value inertia;
  std::vector<Value> ratio;
  std::optional<Vector> axis;
};

struct Joint {
  enum class Form { kMovedAndTurned, kDh, kMdh };
  std::string name, kind = "fixed";  ///< kind in the words of the scene format
  Form form = Form::kMovedAndTurned;
  Vector xyz, rpy, axis = {0, 0, 1};  ///< [m], [rad]
  Value a, alpha, d, theta;           ///< [m], [rad], [m], [rad]
  Value pitch, rotor_inertia, gear_ratio = 1, viscous, positive, negative, stiffness, rest;
  bool gyroscopic = false;
  std::vector<GearedRotor> rotors;
  std::optional<Following> follows;
};

/// Mass [kg], its centre [m], and the six of the inertia [kg m^2] in axes turned by rpy.
struct Solid {
  Value mass;
  Vector com, rpy;
  bool about_com = true;  ///< otherwise about the link's origin
  Value xx, yy, zz, xy, xz, yz;
};

struct Link {
  std::string name;
  int parent = -1;  ///< -1: the root
  Joint joint;
  Solid solid;
};

/// A frame on a link.
struct Anchor {
  std::string link;
  Vector xyz, rpy;
};
struct Closure {
  std::string kind;
  Anchor a, b;
  Value length;
};
struct Spring {
  Anchor a, b;
  Value stiffness, rest, damping;
};
struct Wrench {
  std::string link;
  bool in_world_axes = false;
  Vector force, moment, at;
};
struct AccelerationConstraint {
  std::string link;
  bool in_world_axes = true;
  Vector at, direction, rotation;
  Value value, compliance;
};

struct Description {
  std::string format;  ///< "TOML", "URDF"
  Vector gravity;
  std::vector<Link> links;  ///< in the order of q: parents before children, else the file's order
  std::vector<Closure> closures;
  std::vector<Spring> springs;
  std::vector<Wrench> wrenches;
  std::vector<AccelerationConstraint> acceleration_constraints;
  std::vector<Value> start_q, start_qd;  ///< without followers; empty: not given
  std::vector<std::string> not_read;     ///< what the file has and nothing here looks at
};

/// A format that is not read a second time.
class NotReread : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/** @param text  of the file
    @param file  for the folder of a scene that it is like
    @param bundled  files one of whose names without .toml it may be like, too
    @throws NotReread  MJCF, a scene that is like one of neither, or one whose base is fixed
    @throws std::runtime_error  what could not be read, and why */
Description described(const std::string& text, const std::filesystem::path& file,
                      const std::vector<std::filesystem::path>& bundled = {});

/// Without the mark of the order of bytes.
std::string withoutMark(const std::string& text);
Description describedToml(const std::string& text, const std::filesystem::path& file,
                          const std::vector<std::filesystem::path>& bundled);
Description describedUrdf(const std::string& text);

/// A link and the name of its parent (none: the root), in the file's order.
struct Named {
  Link link;
  std::optional<std::string> parent;
};
/// Parents before their children; of those that may come next, the file's first.
std::vector<Link> inOrder(std::vector<Named> links);

}  // namespace dynwitness::crosscheck::rereading
