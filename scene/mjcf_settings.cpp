// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_settings.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace dynwitness::scene::mjcf {

void Compiler::read(const Node& node) {
  requireKnown(node.element,
               {"angle", "eulerseq", "inertiafromgeom", "inertiagrouprange", "balanceinertia",
                "settotalmass", "boundmass", "boundinertia", "discardvisual", "coordinate",
                "autolimits", "fusestatic"},
               {"meshdir", "texturedir", "assetdir", "strippath", "fitaabb", "convexhull",
                "usethread", "exactmeshinertia", "saveinertial"});
  requireKnown(node, {"lengthrange"});
  const Said said(node.element, kNone);
  if (said.has("angle")) in_degrees = said.word("angle", "", {"degree", "radian"}) == "degree";
  if (said.has("eulerseq")) {
    euler = said.text("eulerseq");
    if (euler.size() != 3 || euler.find_first_not_of("xyzXYZ") != std::string::npos)
      said.fail("eulerseq", "is \"" + euler + "\", allowed: three of x, y, z, X, Y, Z");
  }
  if (said.has("inertiafromgeom"))
    from_geoms = said.word("inertiafromgeom", "", {"true", "false", "auto"});
  if (said.has("inertiagrouprange")) {
    const std::vector<Number> range = said.numbers("inertiagrouprange", 2, 2);
    least_group = static_cast<int>(std::floor(std::clamp(valueOf(range[0]), -1e6L, 1e6L)));
    most_group = static_cast<int>(std::floor(std::clamp(valueOf(range[1]), -1e6L, 1e6L)));
  }
  balance = said.flag("balanceinertia", balance);
  discards_visuals = said.flag("discardvisual", discards_visuals);
  said.word("coordinate", "local", {"local"});
  said.flag("autolimits", true);
  said.flag("fusestatic", true);
  if (said.has("settotalmass")) {
    total_mass = said.number("settotalmass");
    total_mass_where = said.where();
  }
  least_mass = said.number("boundmass", least_mass);
  least_inertia = said.number("boundinertia", least_inertia);
}

void readOption(const Node& node, Mechanism* mechanism) {
  requireKnown(node.element, {"gravity", "density", "viscosity", "wind"},
               {"timestep",
                "apirate",
                "impratio",
                "tolerance",
                "ls_tolerance",
                "noslip_tolerance",
                "ccd_tolerance",
                "mpr_tolerance",
                "sleep_tolerance",
                "magnetic",
                "o_margin",
                "o_solref",
                "o_solimp",
                "o_friction",
                "integrator",
                "collision",
                "cone",
                "jacobian",
                "solver",
                "iterations",
                "ls_iterations",
                "noslip_iterations",
                "ccd_iterations",
                "mpr_iterations",
                "sdf_iterations",
                "sdf_initpoints",
                "actuatorgroupdisable"});
  requireKnown(node, {"flag"});
  const Said said(node.element, kNone);
  mechanism->gravity = said.vector("gravity", mechanism->gravity);
  for (const char* key : {"density", "viscosity"})
    if (!isZero(said.number(key)))
      said.fail(key, "is " + said.text(key) + ": forces of a fluid are not modelled, allowed: 0");
  for (const Node& flags : node.children) {
    const Said of_flags(flags.element, kNone);
    for (const TiXmlAttribute* a = flags.element.xml().FirstAttribute(); a; a = a->Next()) {
      const std::string value = of_flags.word(a->Name(), "", {"enable", "disable"});
      if (value == "enable") continue;
      if (isOneOf(a->Name(), {"gravity"})) mechanism->has_gravity = false;
      if (isOneOf(a->Name(),
                  {"passive", "spring", "damper", "frictionloss", "equality", "constraint"}))
        of_flags.fail(a->Name(),
                      "is disable, which is not in the subset that is read, allowed: "
                      "enable");
    }
  }
}

void Defaults::read(const Node& node, const Class* parent) {
  requireKnown(node.element, {"class"});
  requireKnown(node,
               {"default",  "joint",       "geom",   "equality", "mesh",    "material", "site",
                "camera",   "light",       "pair",   "tendon",   "general", "motor",    "position",
                "velocity", "intvelocity", "damper", "cylinder", "muscle",  "adhesion", "texture"});
  const std::string name =
      parent ? node.element.attribute("class") : Said(node.element, kNone).text("class", "main");
  if (!parent && name != "main")
    node.element.fail("class is \"" + name + "\", allowed for the outermost: main");
  if (parent && (name.empty() || classes_.count(name) > 0))
    node.element.fail("class \"" + name + "\" exists already, allowed: each name once");
  Class& own = classes_[name];
  if (parent) own = *parent;
  const auto take = [](const Element& element, Settings* settings) {
    for (const TiXmlAttribute* a = element.xml().FirstAttribute(); a; a = a->Next()) {
      Setting& setting = (*settings)[a->Name()];
      const std::vector<std::string> before = wordsOf(setting.text);
      setting = {a->Value(), element.where()};
      // of a list, what is not said stays: size="0.1 0.2", then size="0.3"
      if (std::string(a->Name()) != "size") continue;
      for (std::size_t k = wordsOf(setting.text).size(); k < before.size(); ++k)
        setting.text += " " + before[k];
    }
  };
  for (const Node& child : node.children) {
    const std::string kind = child.element.kind();
    if (kind == "joint") {
      requireKnownJoint(child.element);
      take(child.element, &own.joint);
    } else if (kind == "geom") {
      requireKnownGeom(child.element);
      take(child.element, &own.geom);
    } else if (kind == "equality") {
      requireKnown(child.element, {"active"}, {"solref", "solimp"});
      take(child.element, &own.equality);
    }
  }
  for (const Node& child : node.children)
    if (child.element.kind() == "default") read(child, &own);
}

const Class& Defaults::classOf(const Said& said, const char* key, const Class& otherwise) const {
  if (!said.says(key)) return otherwise;
  const auto found = classes_.find(said.text(key));
  if (found == classes_.end())
    said.fail(key, "is \"" + said.text(key) + "\", allowed: a class of a <default>");
  return found->second;
}

}  // namespace dynwitness::scene::mjcf
