// SPDX-License-Identifier: GPL-3.0-or-later
// A URDF file as it is written, with what a scene does not keep: for those that ask what other
// programs make of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::scene {

/// What a URDF says about a link and its joint beside the scene.
struct UrdfPart {
  struct Limits {
    Number lower, upper, effort, velocity;  ///< [rad], [m]; [N m], [N]; [rad/s], [m/s]
  };
  bool has_inertial = false;
  std::optional<Limits> limits;  ///< none: not given, or the joint is continuous
  /// Its boxes, cylinders and spheres for collision, of water: 1000 kg/m^3, in link axes.
  std::vector<MassProperties> solids;
};

struct Urdf {
  Scene scene;                  ///< not validated: inertias may be those of no body, or absent
  std::vector<UrdfPart> parts;  ///< one a link of the mechanism
};

/// @throws InputError  it is no URDF, or no tree
Urdf readUrdfAsWritten(const std::string& text, const std::filesystem::path& file);

/// Each mass or inertia that no body has, as "FILE:LINE: link "NAME": ..."; linear in the links.
std::vector<std::string> impossibleInertias(const Scene& scene);

/// The file without <visual> and <collision>; what is no XML is returned as it is.
std::string urdfWithoutShapes(const std::string& text);

/// The file with these limits at the joints of these names: turning joints are continuous without.
std::string urdfWithLimits(const std::string& text,
                           const std::map<std::string, UrdfPart::Limits>& limits);

/** The file with each impossible inertia replaced by the nearest possible one
    (scene/impossible_inertia.hpp), and a comment at each that says what stood there. What rounding
    to decimals takes from the nearest is added to the moments, as little as makes it possible.
    @param changes  one line a change
    @throws InputError  a mass is negative, or there is inertia without mass: no inertia mends that
    */
std::string mendedUrdf(const std::string& text, const std::filesystem::path& file,
                       std::vector<std::string>* changes);

}  // namespace dynwitness::scene
