// SPDX-License-Identifier: GPL-3.0-or-later
// URDF files, read a second time.
#include <tinyxml.h>

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <sstream>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/rereading/description.hpp"

namespace dynwitness::crosscheck::rereading {
namespace {

using Xml = TiXmlElement;

std::string attribute(const Xml* xml, const char* key) {
  const char* text = xml == nullptr ? nullptr : xml->Attribute(key);
  return text == nullptr ? "" : text;
}

Value number(const std::string& text) {
  std::istringstream words(text);
  std::string word, more;
  words >> word;
  if (words >> more) throw std::runtime_error(fmt::format("\"{}\" is not one number", text));
  return decimal(word);
}
Value number(const Xml* xml, const char* key, const Value& otherwise = 0) {
  const std::string text = attribute(xml, key);
  return text.empty() ? otherwise : number(text);
}
Vector vector(const Xml* xml, const char* key, const Vector& otherwise = {}) {
  const std::string text = attribute(xml, key);
  if (text.empty()) return otherwise;
  std::istringstream words(text);
  Vector out;
  for (Value& x : out) {
    std::string word;
    words >> word;
    x = decimal(word);
  }
  if (std::string more; words >> more)
    throw std::runtime_error(fmt::format("\"{}\" are not three numbers", text));
  return out;
}

/** An angle as a decimal may stand for the fraction of pi that it is next to: a scene takes what is
    within two units in the last place of a double, that is 4 u, of the rounding of what is written,
    u more. */
Value angle(Value x) {
  x.error += 2.5 * std::numeric_limits<double>::epsilon() * x.size();
  return x;
}
Vector angles(const Xml* xml, const char* key) {
  Vector v = vector(xml, key);
  for (Value& x : v) x = angle(x);
  return v;
}

/// Told: elements of another kind than these.
void tellOthers(const Xml* xml, const std::string& what, std::initializer_list<const char*> known,
                std::vector<std::string>* not_read) {
  for (const Xml* e = xml->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const bool is_known = std::any_of(known.begin(), known.end(),
                                      [&](const char* kind) { return e->ValueStr() == kind; });
    if (!is_known) not_read->push_back(fmt::format("<{}> of {}", e->ValueStr(), what));
  }
}

Solid solidOf(const Xml* inertial) {
  Solid out;
  if (inertial == nullptr) return out;
  const Xml* origin = inertial->FirstChildElement("origin");
  const Xml* six = inertial->FirstChildElement("inertia");
  out.mass = number(inertial->FirstChildElement("mass"), "value");
  out.com = vector(origin, "xyz");
  out.rpy = angles(origin, "rpy");
  out.xx = number(six, "ixx");
  out.yy = number(six, "iyy");
  out.zz = number(six, "izz");
  out.xy = number(six, "ixy");
  out.xz = number(six, "ixz");
  out.yz = number(six, "iyz");
  return out;
}

Joint jointOf(const Xml* xml) {
  Joint out;
  out.name = attribute(xml, "name");
  const std::string type = attribute(xml, "type");
  out.kind = type == "continuous" ? "revolute" : type;
  const Xml* origin = xml->FirstChildElement("origin");
  out.xyz = vector(origin, "xyz");
  out.rpy = angles(origin, "rpy");
  if (out.kind == "revolute" || out.kind == "prismatic" || out.kind == "planar")
    out.axis = vector(xml->FirstChildElement("axis"), "xyz", {1, 0, 0});
  if (out.kind != "revolute" && out.kind != "prismatic") return out;
  const Xml* dynamics = xml->FirstChildElement("dynamics");
  out.viscous = number(dynamics, "damping");
  out.positive = out.negative = number(dynamics, "friction");
  if (const Xml* mimic = xml->FirstChildElement("mimic")) {
    const Value offset = number(mimic, "offset");
    out.follows = {attribute(mimic, "joint"), number(mimic, "multiplier", 1),
                   out.kind == "revolute" ? angle(offset) : offset};
  }
  return out;
}

/// The last of these elements in a transmission, its joints or its actuators.
const Xml* inside(const Xml* transmission, const char* kind) {
  const Xml* last = nullptr;
  for (const Xml* e = transmission->FirstChildElement(); e != nullptr;
       e = e->NextSiblingElement()) {
    const std::string name = e->Value();
    if (name == kind) last = e;
    if (name == "joint" || name == "actuator")
      for (const Xml* found = e->FirstChildElement(kind); found != nullptr;
           found = found->NextSiblingElement(kind))
        last = found;
  }
  return last;
}
/// The last joint that a transmission names.
const Xml* jointMovedBy(const Xml* transmission) {
  const Xml* last = nullptr;
  for (const Xml* e = transmission->FirstChildElement("joint"); e != nullptr;
       e = e->NextSiblingElement("joint"))
    last = e;
  return last;
}

/// Rotors, as Drake writes them.
void readTransmission(const Xml* xml, const std::unordered_map<std::string, Joint*>& joints) {
  const Xml* inertia = inside(xml, "drake:rotor_inertia");
  if (inertia == nullptr) return;
  const auto found = joints.find(attribute(jointMovedBy(xml), "name"));
  if (found == joints.end()) throw std::runtime_error("a transmission of no joint");
  Joint& joint = *found->second;
  if (joint.kind != "revolute" && joint.kind != "prismatic") return;
  joint.rotor_inertia = number(inertia, "value");
  if (const Xml* gear = inside(xml, "drake:gear_ratio"))
    joint.gear_ratio = number(gear, "value");
  else if (const Xml* reduction = inside(xml, "mechanicalReduction"))
    joint.gear_ratio = number(reduction->GetText() == nullptr ? "" : reduction->GetText());
}

}  // namespace

Description describedUrdf(const std::string& text) {
  TiXmlDocument document;
  document.Parse(text.c_str());
  const Xml* robot = document.RootElement();
  if (document.Error() || robot == nullptr) throw std::runtime_error("no XML");
  if (robot->ValueStr() == "mujoco") throw NotReread("MJCF is not read a second time");
  if (robot->ValueStr() != "robot")
    throw NotReread(fmt::format("<{}> is not read a second time", robot->ValueStr()));
  Description out;
  out.format = "URDF";
  out.gravity = {0, 0, decimal("-9.81")};  // which the format cannot say, and readers suppose
  tellOthers(robot, "the robot", {"link", "joint", "transmission", "material"}, &out.not_read);
  std::vector<Named> links;
  std::unordered_map<std::string, std::size_t> index;
  for (const Xml* xml = robot->FirstChildElement("link"); xml != nullptr;
       xml = xml->NextSiblingElement("link")) {
    Link link;
    link.name = attribute(xml, "name");
    link.solid = solidOf(xml->FirstChildElement("inertial"));
    tellOthers(xml, "link '" + link.name + "'", {"inertial", "visual", "collision"}, &out.not_read);
    index.emplace(link.name, links.size());
    links.push_back({link, {}});
  }
  std::unordered_map<std::string, Joint*> joints;
  for (const Xml* xml = robot->FirstChildElement("joint"); xml != nullptr;
       xml = xml->NextSiblingElement("joint")) {
    const std::string child = attribute(xml->FirstChildElement("child"), "link");
    const auto found = index.find(child);
    if (found == index.end()) throw std::runtime_error(fmt::format("there is no link '{}'", child));
    Named& named = links[found->second];
    named.link.joint = jointOf(xml);
    named.parent = attribute(xml->FirstChildElement("parent"), "link");
    joints.emplace(named.link.joint.name, &named.link.joint);
    tellOthers(xml, "joint '" + named.link.joint.name + "'",
               {"origin", "parent", "child", "axis", "dynamics", "mimic", "limit", "calibration",
                "safety_controller"},
               &out.not_read);
  }
  for (const Xml* xml = robot->FirstChildElement("transmission"); xml != nullptr;
       xml = xml->NextSiblingElement("transmission"))
    readTransmission(xml, joints);
  out.links = inOrder(std::move(links));
  return out;
}

}  // namespace dynwitness::crosscheck::rereading
