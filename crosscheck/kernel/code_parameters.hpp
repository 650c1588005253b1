// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers of a scene that written code may change: each under a name, with its unit and value.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck::kernel {

/// A field of the struct of parameters.
struct CodeParameter {
  std::string name;  ///< a word that all languages take
  std::string unit;  ///< "kg"; "": it stands where units differ
  std::string what;  ///< "mass:link_2", the words of --set; "a:joint_3"; of a named one its name
};

/// A mechanism in parameters alone.
struct ParametrizedMechanism {
  scene::Mechanism mechanism;  ///< its parameters are the fields, in their order
  std::vector<CodeParameter> fields;
  std::vector<std::string> folded;  ///< the scene's parameters that are values: they turn frames

  /// An expression in the scene's parameters as one in the fields.
  scene::Number inFields(const scene::Number& number) const;

  scene::Mechanism as_written;  ///< where folded and dependent parameters have their meanings
};

/** Gives each number of the scene that motion depends on a name, except those that decide which
    functions of the state there are: angles, axes, what is 0, and gears of 1.

    A parameter that the scene names is a field under its name; one that is made of others follows
    them; one that an angle or an axis depends on is a value. Every other number is a field of its
    own: mass_LINK, com_x_LINK, inertia_xx_LINK, x_JOINT, a_JOINT, damping_JOINT, gravity_z, ... */
ParametrizedMechanism parametrized(const scene::Mechanism& mechanism);

}  // namespace dynwitness::crosscheck::kernel
