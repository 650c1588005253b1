// SPDX-License-Identifier: GPL-3.0-or-later
// A scene with other numbers, another gravity or another base than its file says.
#pragma once

#include <string>
#include <vector>

#include "scene/inertia_need.hpp"
#include "scene/scene.hpp"

namespace dynwitness::scene {

/// As the command line has them; numbers are expressions in the scene's parameters.
struct Changes {
  std::string gravity;            ///< "x,y,z" in world axes [m/s^2]; empty: the scene's
  std::string base;               ///< "floating", "fixed"; empty: as it is
  std::vector<std::string> sets;  ///< "mass:LINK=2", "l=0.3"; see setNames()

  bool isNone() const { return gravity.empty() && base.empty() && sets.empty(); }
};

/// What can be set: "mass:LINK", "com:LINK", ...; a parameter has its name alone.
std::vector<std::string> setNames();

/// How messages call a change, and where it stands: an option stands nowhere.
struct ChangeAsGiven {
  std::string words;  ///< "--set mass:tool=2"
  SourceLocation where;
};
/** Gives one number, or the motion of a joint, another value.
    @param name  "mass:LINK", ..., or a parameter's
    @param text  an expression, or as many as it takes, with commas between them
    @throws InputError  there is no such number, or that is no value of it */
void setNumber(Scene& scene, const std::string& name, const std::string& text,
               const ChangeAsGiven& as_given);
/// @param base  "floating" or "fixed", as changed() has them
void setBase(Scene& scene, const std::string& base, const ChangeAsGiven& as_given);

/** The scene as it is then, under the name NAME_changed, so that nothing that is known of the
    scene's own numbers (published tables, the text of its file) is held against it.

    A base that floats: the scene's root, until then at rest in the world, hangs on a floating joint
    "floating_base" from a new root, at the same place. A base that is fixed: each link that floats
    in the world is fixed where the start has it, to the rounding of a double.

    @throws InputError  a name or a number that is none; a base that is so already, or held
      by a closure or spring of the world; whatever validate() refuses */
Scene changed(const Scene& scene, const Changes& changes,
              InertiaNeed need = InertiaNeed::kOfEachJoint);

}  // namespace dynwitness::scene
