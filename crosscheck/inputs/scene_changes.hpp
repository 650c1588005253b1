// SPDX-License-Identifier: GPL-3.0-or-later
// A scene with other numbers, another gravity or another base than its file says.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace dynwitness::crosscheck {

/// As the command line has them; numbers are expressions in the scene's parameters.
struct SceneChanges {
  std::string gravity;            ///< "x,y,z" in world axes [m/s^2]; empty: the scene's
  std::string base;               ///< "floating", "fixed"; empty: as it is
  std::vector<std::string> sets;  ///< "mass:LINK=2", "l=0.3"; see setNames()

  bool isNone() const { return gravity.empty() && base.empty() && sets.empty(); }
};

/// What can be set: "mass:LINK", "com:LINK", ...; a parameter has its name alone.
std::vector<std::string> setNames();

/** The scene as it is then, under the name NAME_changed, so that nothing that is known of the
    scene's own numbers (published tables, the text of its file) is held against it.

    A base that floats: the scene's root, until then at rest in the world, hangs on a floating joint
    "floating_base" from a new root, at the same place. A base that is fixed: each link that floats
    in the world is fixed where the start has it, to the rounding of a double.

    @throws scene::InputError  a name or a number that is none; a base that is so already, or held
      by a closure or spring of the world; whatever scene::validate() refuses */
scene::Scene changed(const scene::Scene& scene, const SceneChanges& changes);

}  // namespace dynwitness::crosscheck
