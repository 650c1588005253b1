// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/remarks.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include <fmt/format.h>
#include <boost/math/constants/constants.hpp>

#include "scene/faults.hpp"
#include "scene/nearest_name.hpp"
#include "scene/numbers.hpp"
#include "scene/text_file.hpp"
#include "scene/xml_element.hpp"

namespace dynwitness::scene {
namespace {

constexpr double kPi = boost::math::constants::pi<double>(), kTurn = 2 * kPi;

/// What may stand in an element of URDF: https://wiki.ros.org/urdf/XML, urdfdom's quat_xyzw, and
/// what PyBullet and others have made common.
struct Words {
  std::vector<std::string> elements, attributes;
};
const std::map<std::string, Words>& vocabulary() {
  static const std::map<std::string, Words> words = {
      {"link", {{"inertial", "visual", "collision"}, {"name", "type"}}},
      {"inertial", {{"origin", "mass", "inertia"}, {}}},
      {"origin", {{}, {"xyz", "rpy", "quat_xyzw"}}},
      {"mass", {{}, {"value"}}},
      {"inertia", {{}, {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"}}},
      {"joint",
       {{"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller",
         "calibration"},
        {"name", "type"}}},
      {"parent", {{}, {"link"}}},
      {"child", {{}, {"link"}}},
      {"axis", {{}, {"xyz"}}},
      {"limit", {{}, {"lower", "upper", "effort", "velocity", "acceleration", "jerk"}}},
      {"dynamics", {{}, {"damping", "friction"}}},
      {"mimic", {{}, {"joint", "multiplier", "offset"}}}};
  return words;
}

/// Which word of the format is meant by one that it has not; empty: none, it is somebody else's.
std::string meantBy(const std::string& word, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), word) != known.end()) return {};
  if (word.find(':') != std::string::npos) return {};
  return nearestName(word, known);
}

void addMisspelt(const Element& element, const std::string& owner, std::vector<std::string>* said) {
  const auto found = vocabulary().find(element.kind());
  if (found == vocabulary().end()) return;
  const Words& words = found->second;
  const auto add = [&](const Element& at, const std::string& what, const std::string& meant) {
    if (!meant.empty())
      said->push_back(
          fmt::format("{}: {}: <{}> has an unknown {} (did you mean {}?): it is ignored",
                      at.where().text(), owner, element.kind(), what, meant));
  };
  for (const TiXmlAttribute* a = element.xml().FirstAttribute(); a; a = a->Next())
    add(element, fmt::format("attribute {}", a->Name()), meantBy(a->Name(), words.attributes));
  for (const Element& child : element.children()) {
    add(child, "element <" + child.kind() + ">", meantBy(child.kind(), words.elements));
    if (std::count(words.elements.begin(), words.elements.end(), child.kind()) > 0)
      addMisspelt(child, owner, said);
  }
}

std::optional<Element> firstOf(const Element& element, const char* kind) {
  const std::vector<Element> found = element.children(kind);
  return found.empty() ? std::optional<Element>() : found.front();
}

double doubleOf(const Number& n) {
  return exactValue(n, {}).toDouble();
}

void addTurns(const Element& element, const std::string& owner, std::vector<std::string>* said) {
  const std::optional<Element> origin = firstOf(element, "origin");
  if (!origin) return;
  for (const Number& angle : origin->optionalVector("rpy"))
    if (const std::string remark = moreThanATurn(doubleOf(angle), AngleSpelling::kDecimal);
        !remark.empty()) {
      said->push_back(
          fmt::format("{}: {}: <origin>: rpy: {}", origin->where().text(), owner, remark));
      return;
    }
}

void addLimits(const Element& joint, const std::string& owner, std::vector<std::string>* said) {
  const std::string type = joint.optionalAttribute("type");
  const std::optional<Element> limit = firstOf(joint, "limit");
  if (!limit || (type != "revolute" && type != "prismatic")) return;
  const double lower = doubleOf(limit->optionalNumber("lower")),
               upper = doubleOf(limit->optionalNumber("upper"));
  const std::string at = fmt::format("{}: {}: <limit>: ", limit->where().text(), owner);
  if (lower > upper) said->push_back(fmt::format("{}lower {} is above upper {}", at, lower, upper));
  const double largest = std::max(std::abs(lower), std::abs(upper));
  if (type == "revolute" && largest > 2 * kTurn && largest <= 720)
    said->push_back(fmt::format(
        "{}{} to {} rad is up to {:.1f} turns; if it is in degrees, write lower=\"{}\" upper=\"{}\"",
        at, lower, upper, largest / kTurn, lower * kPi / 180, upper * kPi / 180));
}

/// Joints that move no <inertial>: the first, and how many more.
void addMassless(const Element& robot, std::vector<std::string>* said) {
  struct Carried {
    std::string parent, joint;
    bool moves;
  };
  std::unordered_map<std::string, Carried> by;  ///< by the link
  for (const Element& joint : robot.children("joint")) {
    const std::optional<Element> parent = firstOf(joint, "parent"), child = firstOf(joint, "child");
    if (!parent || !child) continue;
    by[child->optionalAttribute("link")] = {parent->optionalAttribute("link"),
                                            joint.optionalAttribute("name"),
                                            joint.optionalAttribute("type") != "fixed"};
  }
  std::set<std::string> heavy;  // with what carries them
  for (const Element& link : robot.children("link")) {
    if (!firstOf(link, "inertial")) continue;
    std::string name = link.optionalAttribute("name");
    while (heavy.insert(name).second) {
      const auto carried = by.find(name);
      if (carried == by.end()) break;
      name = carried->second.parent;
    }
  }
  std::string first;
  std::size_t more = 0;
  for (const Element& link : robot.children("link")) {
    const std::string name = link.optionalAttribute("name");
    const auto carried = by.find(name);
    if (heavy.count(name) > 0 || carried == by.end() || !carried->second.moves) continue;
    if (!first.empty()) {
      ++more;
      continue;
    }
    first = fmt::format(
        "{}: link \"{}\": neither it nor what it carries has an <inertial>: joint \"{}\" moves 0 kg",
        link.where().text(), name, carried->second.joint);
  }
  if (first.empty()) return;
  said->push_back(first + (more == 0   ? ""
                           : more == 1 ? ", and another joint does"
                                       : fmt::format(", and {} more joints do", more)));
}

/// The first, and how many more there are.
std::vector<std::string> shortened(std::vector<std::string> said, const std::string& file) {
  if (said.size() <= Faults::kMostTold) return said;
  const std::size_t more = said.size() - Faults::kMostTold;
  said.resize(Faults::kMostTold);
  said.push_back(fmt::format("{}: ... and {} more remarks", file, more));
  return said;
}

/// None: the file is no regular one, or no XML.
std::optional<std::string> xmlOf(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {};
  std::string text = readTextFile(file, "a TOML, URDF or MJCF file");
  if (!looksLikeXml(text)) return {};
  return text;
}

}  // namespace

std::string moreThanATurn(double angle, AngleSpelling spelling) {
  const double turns = std::abs(angle) / kTurn;
  if (!(turns >= 1.05)) return {};
  const std::string product = fmt::format("{:.6g}*pi/180", angle);
  return fmt::format("{:.6g} rad is {:.1f} turns; if it is in degrees, write {}", angle, turns,
                     spelling == AngleSpelling::kExpression ? product
                     : spelling == AngleSpelling::kText     ? '"' + product + '"'
                                                            : fmt::format("{}", angle * kPi / 180));
}

std::vector<std::string> remarksOnUrdf(const std::string& text, const std::string& file) {
  std::vector<std::string> said;
  TiXmlDocument document;
  try {
    constexpr int kMostDepth = 100;  // the reader's
    parseXml(text, file, kMostDepth, &document);
  } catch (const InputError&) {
    return said;
  }
  const TiXmlElement* top = document.RootElement();
  if (!top || top->ValueStr() != "robot") return said;
  const Element robot(top, &file);
  // what a number that is none hinders is told with that number, by the reader
  const auto collect = [](const auto& part) {
    try {
      part();
    } catch (const InputError&) {
    }
  };
  for (const Element& element : robot.children()) {
    const std::string kind = element.kind();
    if (kind != "link" && kind != "joint") continue;
    collect([&] {
      const std::string owner = fmt::format("{} \"{}\"", kind, element.optionalAttribute("name"));
      addMisspelt(element, owner, &said);
      if (kind == "joint") {
        collect([&] { addTurns(element, owner, &said); });
        addLimits(element, owner, &said);
      } else if (const std::optional<Element> inertial = firstOf(element, "inertial")) {
        addTurns(*inertial, owner, &said);
      }
    });
  }
  collect([&] { addMassless(robot, &said); });
  return shortened(std::move(said), file);
}

std::vector<std::string> remarksOnAngles(const Scene& scene, const std::filesystem::path& file) {
  std::vector<std::string> said;
  const RealNumbers<double> value(scene.mechanism);
  const auto look = [&](const SourceLocation& where, const Number& angle, const auto& what) {
    if (angle.isLiteralZero() || angle.text().find("pi") != std::string::npos) return;
    const std::string remark = moreThanATurn(value(angle), AngleSpelling::kText);
    if (!remark.empty()) said.push_back(fmt::format("{}: {}: {}", where.text(), what(), remark));
  };
  for (const Link& link : scene.mechanism.links) {
    for (const Number& angle : link.inertia.rpy)
      look(link.where, angle, [&] { return fmt::format("link \"{}\": inertia: rpy", link.name); });
    const Placement& p = link.joint.placement;
    const auto lookAt = [&](const Number& angle, const char* key) {
      look(link.where, angle,
           [&] { return fmt::format("joint \"{}\": {}", link.joint.name, key); });
    };
    for (const Number& angle : p.rpy) lookAt(angle, "rpy");
    lookAt(p.alpha, "alpha");
    lookAt(p.theta, "theta");
  }
  const std::vector<SlotKind> slots = scene.mechanism.slots();
  for (std::size_t k = 0; k < std::min(slots.size(), scene.start_q.size()); ++k)
    if (slots[k] == SlotKind::kAngle)
      look({file.string(), 0}, scene.start_q[k],
           [&] { return fmt::format("[start]: q{}", k + 1); });
  return shortened(std::move(said), file.string());
}

std::vector<std::string> remarksOnFile(const std::filesystem::path& file) {
  const std::optional<std::string> text = xmlOf(file);
  return text ? remarksOnUrdf(*text, file.string()) : std::vector<std::string>();
}

std::vector<std::string> remarksOn(const Scene& scene, const std::filesystem::path& file) {
  const std::optional<std::string> text = xmlOf(file);
  return text ? remarksOnUrdf(*text, file.string()) : remarksOnAngles(scene, file);
}

}  // namespace dynwitness::scene
