// SPDX-License-Identifier: GPL-3.0-or-later
// What an MJCF file says once for all its bodies: <compiler>, <option> and classes of <default>.
// For the reader of MJCF (mjcf_*.cpp) alone.
#pragma once

#include <map>
#include <string>

#include "scene/mechanism.hpp"
#include "scene/mjcf_elements.hpp"
#include "scene/mjcf_numbers.hpp"

namespace dynwitness::scene::mjcf {

/// How numbers of the file are meant.
struct Compiler {
  bool in_degrees = true, balance = false, discards_visuals = false;
  std::string euler = "xyz", from_geoms = "auto";
  int least_group = 0, most_group = 5;  ///< of geoms that make inertia
  Number total_mass{-1}, least_mass{0}, least_inertia{0};
  SourceLocation total_mass_where;

  void read(const Node& node);
  Number angle(const Number& n) const { return in_degrees ? ofDegrees(n) : angleOf(n); }
};

/// Gravity, and that nothing acts which is not modelled.
void readOption(const Node& node, Mechanism* mechanism);

/// The defaults of a class, by kind of element.
struct Class {
  Settings joint, geom, equality;
};

/// The classes of a file, of which "main" is always one.
class Defaults {
 public:
  void read(const Node& node, const Class* parent = nullptr);
  const Class& main() const { return classes_.at("main"); }
  /// @param key  the attribute that names it; where there is none: otherwise
  const Class& classOf(const Said& said, const char* key, const Class& otherwise) const;

 private:
  std::map<std::string, Class> classes_ = {{"main", {}}};
};

}  // namespace dynwitness::scene::mjcf
