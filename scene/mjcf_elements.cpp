// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mjcf_elements.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace dynwitness::scene::mjcf {

bool isOneOf(const std::string& name, Names names) {
  return std::any_of(names.begin(), names.end(), [&](const char* n) { return name == n; });
}

void requireKnown(const Element& element, Names used, Names without_effect) {
  for (const TiXmlAttribute* a = element.xml().FirstAttribute(); a; a = a->Next()) {
    if (isOneOf(a->Name(), used) || isOneOf(a->Name(), without_effect)) continue;
    std::string allowed;
    for (const Names& names : {used, without_effect})
      for (const char* name : names) allowed += (allowed.empty() ? "" : ", ") + std::string(name);
    element.fail(fmt::format("{}=\"{}\" is not in the subset that is read, allowed: {}", a->Name(),
                             a->Value(), allowed));
  }
}

void requireKnown(const Node& node, Names children) {
  for (const Node& child : node.children) {
    if (isOneOf(child.element.kind(), children)) continue;
    std::string allowed;
    for (const char* name : children) allowed += (allowed.empty() ? "" : ", ") + std::string(name);
    child.element.fail("not in the subset that is read, allowed in <" + node.element.kind() +
                       ">: " + (allowed.empty() ? "nothing" : allowed));
  }
}

void requireKnownGeom(const Element& element) {
  requireKnown(
      element,
      {"name", "class", "type", "size", "fromto", "pos", "quat", "euler", "axisangle", "xyaxes",
       "zaxis", "mass", "density", "group", "mesh", "contype", "conaffinity", "shellinertia"},
      {"condim", "priority", "material", "friction", "solmix", "solref", "solimp", "margin", "gap",
       "hfield", "fitscale", "rgba", "fluidshape", "fluidcoef", "user"});
}

void requireKnownJoint(const Element& element) {
  requireKnown(element,
               {"name", "class", "type", "pos", "axis", "ref", "springref", "stiffness", "damping",
                "frictionloss", "armature", "springdamper"},
               {"limited", "range", "margin", "solreflimit", "solimplimit", "solreffriction",
                "solimpfriction", "actuatorfrcrange", "actuatorfrclimited", "group", "user"});
}

void Said::fail(const char* key, const std::string& what) const {
  const std::optional<Setting> found = setting(key);
  throw InputError(found ? found->where : where(),
                   fmt::format("<{}>: {} {}", own_.kind(), key, what));
}

std::string Said::text(const char* key, const std::string& otherwise) const {
  const std::optional<Setting> found = setting(key);
  return found ? found->text : otherwise;
}

std::vector<Number> Said::numbers(const char* key, std::size_t least, std::size_t most) const {
  const Setting found = setting(key).value();
  std::vector<Number> out;
  for (const std::string& word : wordsOf(found.text))
    out.push_back(decimalOf(word, found.where, fmt::format("<{}>: {}", own_.kind(), key)));
  if (out.size() < least || out.size() > most)
    fail(key,
         fmt::format("has {} numbers, allowed: {}", out.size(),
                     least == most ? std::to_string(most) : fmt::format("{} to {}", least, most)));
  return out;
}

Number Said::number(const char* key, const Number& otherwise) const {
  return has(key) ? numbers(key, 1, 1)[0] : otherwise;
}

Vector Said::vector(const char* key, const Vector& otherwise) const {
  if (!has(key)) return otherwise;
  const std::vector<Number> v = numbers(key, 3, 3);
  return {v[0], v[1], v[2]};
}

std::vector<Number> Said::overlaid(const char* key, std::size_t most) const {
  if (!has(key)) return {};
  std::vector<Number> out = numbers(key, 1, most);
  const auto of_class = otherwise_.find(key);
  if (!says(key) || of_class == otherwise_.end()) return out;
  const std::vector<std::string> words = wordsOf(of_class->second.text);
  for (std::size_t k = out.size(); k < std::min(words.size(), most); ++k)
    out.push_back(
        decimalOf(words[k], of_class->second.where, fmt::format("<{}>: {}", own_.kind(), key)));
  return out;
}

std::string Said::word(const char* key, const std::string& otherwise, Names allowed) const {
  std::string found = text(key, otherwise);
  if (isOneOf(found, allowed)) return found;
  std::string list;
  for (const char* name : allowed) list += (list.empty() ? "" : ", ") + std::string(name);
  fail(key, "is \"" + found + "\", allowed: " + list);
}

bool Said::flag(const char* key, bool otherwise) const {
  return word(key, otherwise ? "true" : "false", {"true", "false"}) == "true";
}

std::optional<Setting> Said::setting(const char* key) const {
  if (says(key)) return Setting{own_.optionalAttribute(key), own_.where()};
  const auto found = otherwise_.find(key);
  if (found == otherwise_.end()) return {};
  return found->second;
}

}  // namespace dynwitness::scene::mjcf
