// SPDX-License-Identifier: GPL-3.0-or-later
// Writes scenes as URDF, for programs that read nothing else.
//
// Every frame of the scene is a frame of the file. A Denavit-Hartenberg link, whose frame is not
// the frame of its joint, hangs on a massless one that is.
#include <tinyxml.h>

#include <fmt/format.h>

#include "scene/mimic.hpp"
#include "scene/scene.hpp"
#include "scene/text_file.hpp"
#include "scene/written_numbers.hpp"

namespace dynwitness::scene {
namespace {

using written::escaped;
using written::Numbers;
using written::Origin;
using written::Real;
using written::text;
using written::Vector3;

std::string originElement(const Origin& origin) {
  std::string attributes;
  if (!origin.xyz.isZero(0)) attributes += fmt::format(" xyz=\"{}\"", text(origin.xyz));
  if (!origin.rpy.isZero(0)) attributes += fmt::format(" rpy=\"{}\"", text(origin.rpy));
  return attributes.empty() ? "" : "<origin" + attributes + "/>";
}

std::string inertial(const MassProperties& p, const Numbers& number) {
  const written::Inertial m = written::aboutCenterOfMass(p, number);
  return fmt::format(
      "<inertial>{}<mass value=\"{}\"/><inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" "
      "iyz=\"{}\" izz=\"{}\"/></inertial>",
      originElement(m.origin), text(m.mass), text(m.I(0, 0)), text(m.I(0, 1)), text(m.I(0, 2)),
      text(m.I(1, 1)), text(m.I(1, 2)), text(m.I(2, 2)));
}

std::string jointElement(const std::string& name, const char* type, const std::string& parent,
                         const std::string& child, const Origin& origin,
                         const std::string& more = "") {
  return fmt::format(
      "  <joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>{}{}</joint>\n",
      escaped(name), type, escaped(parent), escaped(child), originElement(origin), more);
}

std::string linkElement(const std::string& name, const MassProperties& inertia,
                        const Numbers& number) {
  return fmt::format("  <link name=\"{}\">{}</link>\n", escaped(name), inertial(inertia, number));
}

/// Friction, as far as URDF has words for it: viscous, and Coulomb's when it is the same both ways.
std::string dynamics(const Joint& joint, const Numbers& number) {
  const Friction& friction = joint.friction;
  std::string words;
  if (number(friction.viscous) != 0)
    words += fmt::format(" damping=\"{}\"", text(number(friction.viscous)));
  if (number(friction.positive) != 0 && number(friction.positive) == number(friction.negative))
    words += fmt::format(" friction=\"{}\"", text(number(friction.positive)));
  return words.empty() ? "" : "<dynamics" + words + "/>";
}

std::string mimic(const Joint& joint, const Numbers& number) {
  if (!joint.mimic) return "";
  const auto attribute = [&](const char* key, const Number& n, int otherwise) {
    const Real x = number(n);
    return x == otherwise ? std::string() : fmt::format(" {}=\"{}\"", key, text(x));
  };
  return fmt::format("<mimic joint=\"{}\"{}{}/>", escaped(joint.mimic->joint),
                     attribute("multiplier", joint.mimic->multiplier, 1),
                     attribute("offset", joint.mimic->offset, 0));
}

/// What URDF calls a moving joint.
const char* urdfType(const Link& link) {
  switch (link.joint.kind) {
    case JointKind::kRevolute:
      return "continuous";
    case JointKind::kPrismatic:
      return "prismatic";
    case JointKind::kPlanar:
      return "planar";
    case JointKind::kFloating:
      return "floating";
    default:
      throw InputError(link.where,
                       fmt::format("joint \"{}\" is {}, allowed in URDF: fixed, revolute, "
                                   "prismatic, planar, floating",
                                   link.joint.name, name(link.joint.kind)));
  }
}

std::string linkAndJoint(const Mechanism& mechanism, const Link& link, const Numbers& number) {
  std::string element = linkElement(link.name, link.inertia, number);
  if (link.parent < 0) return element;
  const Joint& joint = link.joint;
  const std::string& parent = mechanism.links[link.parent].name;
  const Origin before = written::jointOrigin(joint.placement, number);
  const std::vector<Step> after_joint = joint.placement.afterJoint();
  if (joint.kind == JointKind::kFixed) {
    std::vector<Step> steps = joint.placement.beforeJoint();
    steps.insert(steps.end(), after_joint.begin(), after_joint.end());
    return element + jointElement(joint.name, "fixed", parent, link.name,
                                  after_joint.empty() ? before : written::composed(steps, number));
  }

  const char* type = urdfType(link);
  std::string axis = fmt::format("<axis xyz=\"{}\"/>", text(written::vector(joint.axis, number)));
  if (joint.kind == JointKind::kPrismatic)  // URDF has no slide without ends
    axis += R"(<limit lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"/>)";
  if (joint.kind == JointKind::kFloating) axis.clear();
  axis += dynamics(joint, number) + mimic(joint, number);
  const Origin after = written::composed(after_joint, number);
  if (after.isNone())
    return element + jointElement(joint.name, type, parent, link.name, before, axis);
  const std::string moved = link.name + ".joint_frame";
  return linkElement(moved, {}, number) +
         jointElement(joint.name, type, parent, moved, before, axis) + element +
         jointElement(joint.name + ".to_link_frame", "fixed", moved, link.name, after);
}

/// What the scene has and URDF has no words for.
std::string leftOut(const Mechanism& mechanism, const Numbers& number) {
  bool rotors = false, springs = false, one_sided = false;
  for (const Link& link : mechanism.links) {
    rotors = rotors || number(link.joint.rotor_inertia) != 0 || !link.joint.rotors.empty();
    springs = springs || number(link.joint.stiffness) != 0;
    one_sided =
        one_sided || number(link.joint.friction.positive) != number(link.joint.friction.negative);
  }
  std::string what = mechanism.has_gravity
                         ? "gravity (" + text(written::vector(mechanism.gravity, number)) + ")"
                         : "that there is no gravity";
  if (rotors) what += ", rotors";
  if (springs) what += ", springs";
  if (one_sided) what += ", Coulomb friction that is not the same both ways";
  if (!mechanism.wrenches.empty()) what += ", loads";
  if (!mechanism.isOpenTree()) what += ", closures and springs between points";
  return what;
}

/// The file without <visual>, <collision> and <mimic>; empty when it is not a URDF file.
std::string withoutGeometryAndMimics(const std::string& file_text) {
  TiXmlDocument document;
  document.Parse(file_text.c_str());
  TiXmlElement* robot = document.RootElement();
  if (document.Error() || !robot || robot->ValueStr() != "robot") return "";
  for (TiXmlElement* link = robot->FirstChildElement("link"); link;
       link = link->NextSiblingElement("link")) {
    for (const char* geometry : {"visual", "collision"})
      while (TiXmlElement* found = link->FirstChildElement(geometry)) link->RemoveChild(found);
  }
  for (TiXmlElement* joint = robot->FirstChildElement("joint"); joint;
       joint = joint->NextSiblingElement("joint"))
    while (TiXmlElement* found = joint->FirstChildElement("mimic")) joint->RemoveChild(found);
  TiXmlPrinter printer;
  document.Accept(&printer);
  return printer.Str();
}

}  // namespace

std::string writeSceneUrdf(const Scene& scene) {
  const Mechanism& mechanism = scene.mechanism;
  const Numbers number(mechanism);
  std::string out = fmt::format("<robot name=\"{}\">\n", escaped(scene.title));
  out += fmt::format("  <!-- the scene also says, and URDF cannot: {} -->\n",
                     leftOut(mechanism, number));
  for (const Link& link : mechanism.links) out += linkAndJoint(mechanism, link, number);
  return out + "</robot>\n";
}

std::string urdfForEngines(const Scene& scene) {
  Scene tree = scene;
  tree.mechanism = withoutMimics(scene.mechanism);
  std::error_code error;
  if (scene.file.extension() == ".urdf" && std::filesystem::is_regular_file(scene.file, error)) {
    const std::string original = readTextFile(scene.file, "a URDF file");
    std::string kept = withoutGeometryAndMimics(original);
    if (!kept.empty()) {
      Scene read = readSceneUrdf(original, scene.file);
      read.mechanism = withoutMimics(read.mechanism);
      if (writeSceneUrdf(read) == writeSceneUrdf(tree)) return kept;
    }
  }
  return writeSceneUrdf(tree);
}

}  // namespace dynwitness::scene
