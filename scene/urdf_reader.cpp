// SPDX-License-Identifier: GPL-3.0-or-later
// Reads URDF files as scenes.
//
// Two parsers look at the file. TinyXML gives the elements: their line numbers, and their numbers
// as they are spelled, which are taken as exact decimals. urdfdom, whose own data are doubles and
// quaternions by then, judges whether the file is URDF at all; whatever it complains about is an
// error here, because it would go on without the part that it could not read.
#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>

#include <fmt/format.h>

#include "scene/arrange.hpp"
#include "scene/faults.hpp"
#include "scene/impossible_inertia.hpp"
#include "scene/inertia_need.hpp"
#include "scene/mimic.hpp"
#include "scene/scene.hpp"
#include "scene/urdf.hpp"
#include "scene/work.hpp"
#include "scene/xml_element.hpp"

namespace dynwitness::scene {
namespace {

// ------------------------------------------------------------------------------ links, joints

/// @param faults  gets what is wrong with its numbers
Link readLink(const Element& element, Faults& faults) {
  Link link;
  link.name = element.attribute("name");
  link.where = element.where();
  const std::optional<Element> inertial = element.child("inertial");
  if (!inertial) return link;
  MassProperties& p = link.inertia;
  const auto required = [&](const char* kind) {
    if (inertial->children(kind).empty())
      throw InputError(inertial->where(), "link \"" + link.name + "\": <inertial>: has no <" +
                                              kind + ">, allowed: <mass> and <inertia>");
    return inertial->requiredChild(kind);
  };
  faults.collect([&] { p.mass = required("mass").number("value"); });
  faults.collect([&] {
    const std::optional<Element> origin = inertial->child("origin");
    if (!origin) return;
    faults.collect([&] { p.com = origin->optionalVector("xyz"); });
    p.rpy = origin->optionalAngles("rpy");
  });
  const Element inertia = required("inertia");
  const std::pair<const char*, Number*> six[] = {{"ixx", &p.xx}, {"iyy", &p.yy}, {"izz", &p.zz},
                                                 {"ixy", &p.xy}, {"ixz", &p.xz}, {"iyz", &p.yz}};
  for (const auto& [key, number] : six)
    faults.collect([&, key = key, number = number] { *number = inertia.number(key); });
  return link;
}

JointKind readJointKind(const Element& element, const std::string& joint) {
  const std::string kind = element.attribute("type");
  if (kind == "fixed") return JointKind::kFixed;
  if (kind == "revolute" || kind == "continuous") return JointKind::kRevolute;
  if (kind == "prismatic") return JointKind::kPrismatic;
  if (kind == "planar") return JointKind::kPlanar;
  if (kind == "floating") return JointKind::kFloating;
  element.fail("joint \"" + joint + "\" is of type \"" + kind +
               "\", allowed: fixed, revolute, continuous, prismatic, planar, floating");
}

bool hasOnePosition(JointKind kind) {
  return positionSlots(kind).size() == 1;
}

/** `damping` is viscous friction, `friction` Coulomb's: URDF calls it static, and means the force
    that has to be overcome. */
Joint readJoint(const Element& element) {
  Joint joint;
  joint.name = element.attribute("name");
  if (joint.name.empty()) element.fail("empty name");
  joint.kind = readJointKind(element, joint.name);
  if (const std::optional<Element> origin = element.child("origin")) {
    joint.placement.xyz = origin->optionalVector("xyz");
    joint.placement.rpy = origin->optionalAngles("rpy");
  }
  // an axis, if given, means nothing
  if (joint.kind == JointKind::kFixed || joint.kind == JointKind::kFloating) return joint;
  joint.axis = {1, 0, 0};  // what URDF means by leaving it out
  if (const std::optional<Element> axis = element.child("axis")) {
    joint.axis = axis->optionalVector("xyz");
  }
  if (hasOnePosition(joint.kind)) {
    if (const std::optional<Element> dynamics = element.child("dynamics")) {
      joint.friction.viscous = dynamics->optionalNumber("damping");
      joint.friction.positive = joint.friction.negative = dynamics->optionalNumber("friction");
    }
  }
  if (const std::optional<Element> mimic = element.child("mimic")) {
    joint.mimic = Mimic{mimic->attribute("joint"), mimic->optionalNumber("multiplier", 1),
                        mimic->optionalNumber("offset")};
    if (joint.kind == JointKind::kRevolute) joint.mimic->offset = angleOf(joint.mimic->offset);
  }
  return joint;
}

/// What a joint says and a scene cannot, as one line; empty when there is nothing.
std::string notModelled(const Element& element) {
  std::string said;
  const auto add = [&said](const std::string& what) { said += (said.empty() ? "" : ", ") + what; };
  const std::optional<Element> dynamics = element.child("dynamics");
  if (dynamics && !hasOnePosition(readJointKind(element, element.attribute("name")))) {
    for (const char* key : {"damping", "friction"}) {
      const Number n = dynamics->optionalNumber(key);
      if (!exactValue(n, {}).isZero()) add(std::string(key) + " " + n.text());
    }
  }
  if (readJointKind(element, element.attribute("name")) == JointKind::kFixed &&
      element.child("mimic"))
    add("mimic (the joint is fixed)");
  if (said.empty()) return said;
  return "joint " + element.attribute("name") + ": " + said + " not modelled";
}

/// A box, cylinder or sphere of water, in link axes; nothing for a mesh.
std::optional<MassProperties> solidOf(const Element& collision) {
  const std::optional<Element> geometry = collision.child("geometry");
  if (!geometry) return {};
  MassProperties m;
  if (const std::optional<Element> origin = collision.child("origin")) {
    m.com = origin->optionalVector("xyz");
    m.rpy = origin->optionalAngles("rpy");
  }
  const auto put = [&m](const std::string& mass, const std::string& xx, const std::string& yy,
                        const std::string& zz) {
    const auto number = [](const std::string& text) { return Expression::parse(text); };
    m.mass = number(mass);
    m.xx = number(fmt::format("{}*({})", mass, xx));
    m.yy = number(fmt::format("{}*({})", mass, yy));
    m.zz = number(fmt::format("{}*({})", mass, zz));
    return m;
  };
  const auto square = [](const Number& n) { return fmt::format("({})^2", n.text()); };
  if (const std::optional<Element> box = geometry->child("box")) {
    const Vector v = box->optionalVector("size");
    const std::string x = square(v[0]), y = square(v[1]), z = square(v[2]);
    return put(fmt::format("1000*({})*({})*({})", v[0].text(), v[1].text(), v[2].text()),
               fmt::format("({} + {})/12", y, z), fmt::format("({} + {})/12", x, z),
               fmt::format("({} + {})/12", x, y));
  }
  if (const std::optional<Element> cylinder = geometry->child("cylinder")) {
    const Number length = cylinder->number("length");
    const std::string r = square(cylinder->number("radius"));
    const std::string across = fmt::format("{}/4 + {}/12", r, square(length));
    return put(fmt::format("1000*pi*{}*({})", r, length.text()), across, across, r + "/2");
  }
  if (const std::optional<Element> sphere = geometry->child("sphere")) {
    const Number radius = sphere->number("radius");
    const std::string moment = fmt::format("2*{}/5", square(radius));
    return put(fmt::format("4000*pi*({})^3/3", radius.text()), moment, moment, moment);
  }
  return {};
}

/// What the file says about a link beside the scene.
UrdfPart partOf(const Element& link) {
  UrdfPart part;
  part.has_inertial = link.child("inertial").has_value();
  for (const Element& collision : link.children("collision"))
    if (const std::optional<MassProperties> solid = solidOf(collision))
      part.solids.push_back(*solid);
  return part;
}

/** A rotor stands in <transmission><actuator> as Drake writes it: <drake:rotor_inertia value> and
    <drake:gear_ratio value>, for which <mechanicalReduction> stands in. A reduction without an
    inertia moves nothing, and what else speaks of inertia is not known; both are told. */
void readTransmission(const Element& element, std::vector<NamedLink>& links,
                      std::vector<std::string>* not_modelled) {
  const std::string name = element.optionalAttribute("name");
  std::optional<Number> inertia, gear, reduction;
  std::string unknown;  // words of inertia that are not Drake's
  const auto look = [&](const Element& child) {
    const std::string kind = child.kind();
    if (kind == "drake:rotor_inertia")
      inertia = child.number("value");
    else if (kind == "drake:gear_ratio")
      gear = child.number("value");
    else if (kind == "mechanicalReduction")
      reduction = child.numberInside();
    else if (kind.find("nertia") != std::string::npos) {
      unknown = "<" + kind + ">";
      not_modelled->push_back("transmission " + name + ": " + unknown +
                              " not modelled (allowed: <drake:rotor_inertia>)");
    }
  };
  std::string joint;
  for (const Element& child : element.children()) {
    look(child);
    if (child.kind() == "joint") {
      joint = child.attribute("name");
      for (const Element& inner : child.children()) look(inner);
    }
    if (child.kind() == "actuator")
      for (const Element& inner : child.children()) look(inner);
  }
  if (!inertia) {
    if (const std::optional<Number>& ratio = gear ? gear : reduction;
        ratio && !(exactValue(*ratio, {}) == Exact{1, 0}))
      not_modelled->push_back(
          "transmission " + name + ": reduction " + ratio->text() + " not modelled (no " +
          (unknown.empty() ? "rotor inertia" : "<drake:rotor_inertia>") + " is given)");
    return;
  }
  const auto found = std::find_if(links.begin(), links.end(), [&](const NamedLink& named) {
    return named.parent && named.link.joint.name == joint;
  });
  if (found == links.end()) element.fail("joint \"" + joint + "\" is not a joint of this robot");
  if (!hasOnePosition(found->link.joint.kind)) {
    not_modelled->push_back("transmission " + name + ": rotor of joint " + joint +
                            " not modelled (the joint is " + scene::name(found->link.joint.kind) +
                            ")");
    return;
  }
  found->link.joint.rotor_inertia = *inertia;
  if (gear || reduction) found->link.joint.gear_ratio = gear ? *gear : *reduction;
}

// ----------------------------------------------------------------------- urdfdom's own verdict

/// Keeps what urdfdom says from standard error, while it lives.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() { console_bridge::useOutputHandler(this); }
  ~Listener() override { console_bridge::restorePreviousOutputHandler(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    complaints += (complaints.empty() ? "" : "; ") + text;
  }

  std::string complaints;
};

/// After arrange(): of what is no tree, urdfdom would let go link by link, each inside the one
/// before.
void requireValidUrdf(const std::string& text, const std::string& file) {
  Listener listener;
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  // a link owns its children: let go one after the other, or a long chain's end is the stack's
  if (model)
    for (const auto& [name, link] : model->links_) {
      link->child_links.clear();
      link->child_joints.clear();
    }
  if (model && listener.complaints.empty()) return;
  throw InputError({file, 0}, "not valid URDF: " + listener.complaints);
}

}  // namespace

Urdf readUrdfAsWritten(const std::string& text, const std::filesystem::path& file) {
  const std::string name = file.string();
  constexpr int kMostDepth = 100;  // a robot needs 6
  TiXmlDocument document;
  parseXml(text, name, kMostDepth, &document);
  const TiXmlElement* top = document.RootElement();
  if (!top) throw InputError({name, 0}, "not URDF: there is no element");
  if (top->ValueStr() != "robot") {
    throw InputError({name, top->Row()}, "not URDF: the outermost element is <" + top->ValueStr() +
                                             ">, allowed: <robot>");
  }
  const Element robot(top, &name);
  for (const Element& element : robot.children())
    if (element.kind().compare(0, 6, "xacro:") == 0)
      element.fail("the file is in xacro, which writes URDF, allowed: what it writes (xacro " +
                   name + " > robot.urdf)");

  Urdf urdf;
  Scene& scene = urdf.scene;
  scene.file = file;
  scene.name = file.stem().string();
  scene.title = robot.attribute("name");
  scene.source = "URDF file " + file.filename().string();

  std::vector<NamedLink> links;
  std::unordered_map<std::string, std::size_t> index;
  bool has_limits = false;
  std::unordered_map<std::string, UrdfPart> parts;
  const std::vector<Element> link_elements = robot.children("link"),
                             joint_elements = robot.children("joint");
  // arranged and asked of urdfdom after, validated by whoever asked: about as long again
  Work reading("", 2.0 * static_cast<double>(link_elements.size() + joint_elements.size()));
  Faults faults;
  std::set<std::string> unread;  ///< links that are not what they should be
  for (const Element& element : link_elements) {
    reading.done();
    faults.collect([&] {
      unread.insert(element.attribute("name"));
      links.push_back({readLink(element, faults), {}, {}});
      unread.erase(links.back().link.name);
      index.emplace(links.back().link.name, links.size() - 1);
      parts.emplace(links.back().link.name, partOf(element));
    });
  }
  const auto joinLink = [&](const Element& element) {
    const Joint joint = readJoint(element);
    const Element child = element.requiredChild("child"), parent = element.requiredChild("parent");
    const std::string child_name = child.attribute("link");
    const auto place = index.find(child_name);
    if (place == index.end()) {
      if (unread.count(child_name) > 0) return;  // which was told
      child.fail("joint \"" + joint.name + "\": child \"" + child_name + "\" is not a link");
    }
    NamedLink* const found = &links[place->second];
    if (found->parent) {
      child.fail("joint \"" + joint.name + "\": link \"" + child_name +
                 "\" is the child of joint \"" + found->link.joint.name +
                 "\" already, allowed: a tree");
    }
    found->link.joint = joint;
    found->parent = parent.attribute("link");
    found->parent_where = parent.where();
    const std::string left_out = notModelled(element);
    if (!left_out.empty()) scene.not_modelled.push_back(left_out);
    const std::optional<Element> limit = element.child("limit");
    has_limits = has_limits || limit;
    if (!limit || element.attribute("type") == "continuous") return;
    parts[child_name].limits =
        UrdfPart::Limits{limit->optionalNumber("lower"), limit->optionalNumber("upper"),
                         limit->optionalNumber("effort"), limit->optionalNumber("velocity")};
  };
  for (const Element& element : joint_elements) {
    reading.done();
    faults.collect([&] { joinLink(element); });
  }
  faults.raise();  // what is said of the tree hangs on all
  for (const Element& element : robot.children("transmission"))
    readTransmission(element, links, &scene.not_modelled);
  if (has_limits) {
    scene.not_modelled.push_back("joint limits (position, velocity, effort) not modelled");
  }
  Mechanism& mechanism = scene.mechanism;
  mechanism.links = arrange(links, name);
  mechanism.has_gravity = true;  // URDF cannot say; every reader of it supposes this
  mechanism.gravity = {0, 0, Expression::parse("-9.81")};
  scene.start_q = mechanism.restPosition();
  scene.start_qd.resize(static_cast<std::size_t>(mechanism.dof()));

  requireValidUrdf(text, name);
  requireUniqueNames(mechanism.links);
  followers(mechanism);  // refuses those that follow nobody
  for (const Link& link : mechanism.links) urdf.parts.push_back(std::move(parts[link.name]));
  return urdf;
}

Scene readSceneUrdf(const std::string& text, const std::filesystem::path& file) {
  return readSceneUrdf(text, file, InertiaNeed::kOfEachJoint);
}

Scene readSceneUrdf(const std::string& text, const std::filesystem::path& file, InertiaNeed need) {
  Scene scene = readUrdfAsWritten(text, file).scene;
  validate(scene, need);
  return scene;
}

std::string urdfWithoutShapes(const std::string& text) {
  TiXmlDocument document;
  document.Parse(text.c_str());
  TiXmlElement* robot = document.RootElement();
  if (document.Error() || !robot) return text;
  for (TiXmlElement* link = robot->FirstChildElement("link"); link;
       link = link->NextSiblingElement("link"))
    for (const char* shape : {"visual", "collision"})
      while (TiXmlElement* found = link->FirstChildElement(shape)) link->RemoveChild(found);
  TiXmlPrinter printer;
  document.Accept(&printer);
  return printer.Str();
}

std::string urdfWithLimits(const std::string& text,
                           const std::map<std::string, UrdfPart::Limits>& limits) {
  TiXmlDocument document;
  document.Parse(text.c_str());
  TiXmlElement* robot = document.RootElement();
  if (document.Error() || !robot) return text;
  for (TiXmlElement* joint = robot->FirstChildElement("joint"); joint;
       joint = joint->NextSiblingElement("joint")) {
    const auto found = limits.find(joint->Attribute("name"));
    if (found == limits.end()) continue;
    if (joint->Attribute("type") == std::string("continuous"))
      joint->SetAttribute("type", "revolute");
    while (TiXmlElement* old = joint->FirstChildElement("limit")) joint->RemoveChild(old);
    TiXmlElement limit("limit");
    const UrdfPart::Limits& l = found->second;
    limit.SetAttribute("lower", l.lower.text());
    limit.SetAttribute("upper", l.upper.text());
    limit.SetAttribute("effort", l.effort.text());
    limit.SetAttribute("velocity", l.velocity.text());
    joint->InsertEndChild(limit);
  }
  TiXmlPrinter printer;
  printer.SetIndent("  ");
  document.Accept(&printer);
  return printer.Str();
}

std::string mendedUrdf(const std::string& text, const std::filesystem::path& file,
                       std::vector<std::string>* changes) {
  const Urdf urdf = readUrdfAsWritten(text, file);
  TiXmlDocument document;
  document.Parse(text.c_str());
  std::unordered_map<std::string, const Link*> links;
  for (const Link& link : urdf.scene.mechanism.links) links.emplace(link.name, &link);
  const auto exactly = [](const Number& n) { return exactValue(n, {}).approximation(); };
  for (TiXmlElement* xml = document.RootElement()->FirstChildElement("link"); xml;
       xml = xml->NextSiblingElement("link")) {
    const Link& link = *links.at(xml->Attribute("name"));
    const MassProperties& m = link.inertia;
    const std::array<const Number*, 6> numbers = {&m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz};
    std::array<double, 6> given;
    bool has_inertia = false;
    for (std::size_t k = 0; k < 6; ++k) {
      given[k] = exactValue(*numbers[k], {}).toDouble();
      has_inertia = has_inertia || given[k] != 0;
    }
    if (const Rational mass = exactly(m.mass); mass < 0 || (mass == 0 && has_inertia))
      throw InputError(link.where, "link \"" + link.name + "\": mass is " + m.mass.text() +
                                       " kg, which no inertia mends, allowed: above zero");
    const auto isPossible = [](const std::array<Rational, 6>& I) {
      bool ignored = false;
      return isRealizable({{{I[0], I[3], I[4]}, {I[3], I[1], I[5]}, {I[4], I[5], I[2]}}}, 0,
                          &ignored);
    };
    std::array<Rational, 6> tried;
    for (std::size_t k = 0; k < 6; ++k) tried[k] = exactly(*numbers[k]);
    if (isPossible(tried)) continue;
    const std::array<double, 6> near = nearestPossible(given);
    const double unit =
        std::max({near[0], near[1], near[2]}) * std::numeric_limits<double>::epsilon();
    std::array<std::string, 6> printed;
    for (double added = 0; !isPossible(tried); added = added == 0 ? unit : 2 * added)
      for (std::size_t k = 0; k < 6; ++k) {
        printed[k] = fmt::format("{:.17g}", near[k] + (k < 3 ? added : 0));
        tried[k] = exactly(Expression::parse(printed[k]));
      }
    TiXmlElement* inertial = xml->FirstChildElement("inertial");
    TiXmlElement* inertia = inertial->FirstChildElement("inertia");
    std::string before, after;
    const char* const keys[] = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    for (std::size_t k = 0; k < 6; ++k) {
      before += fmt::format("{}{}={}", k == 0 ? "" : " ", keys[k], inertia->Attribute(keys[k]));
      after += fmt::format("{}{}={}", k == 0 ? "" : " ", keys[k], printed[k]);
      inertia->SetAttribute(keys[k], printed[k]);
    }
    TiXmlComment comment;
    comment.SetValue(" mended by dynwitness: no body has " + before +
                     "; the nearest possible inertia (pseudo-inertia matrix, Frobenius norm) ");
    inertial->InsertBeforeChild(inertia, comment);
    changes->push_back(fmt::format("{}: link \"{}\": {} instead of {}", link.where.text(),
                                   link.name, after, before));
  }
  TiXmlPrinter printer;
  printer.SetIndent("  ");
  document.Accept(&printer);
  return printer.Str();
}

}  // namespace dynwitness::scene
