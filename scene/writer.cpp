// SPDX-License-Identifier: GPL-3.0-or-later
// Writes scenes as TOML (data/scenes/README.md). What has its default value is left out, so a scene
// reads as short as its author would write it. What a URDF or MJCF file says beyond the scene
// (Scene::not_modelled) does not come back: the written file says nothing that is not modelled.
#include <algorithm>
#include <cctype>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "scene/envelope.hpp"
#include "scene/mimic.hpp"
#include "scene/scene.hpp"

namespace dynwitness::scene {
namespace {

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += std::string("\\") + c;
    } else if (byte < 0x20 || byte == 0x7F) {
      result += fmt::format("\\u{:04X}", byte);
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string_view takeDigits(std::string_view* text) {
  std::size_t n = 0;
  while (n < text->size() && std::isdigit(static_cast<unsigned char>((*text)[n]))) ++n;
  const std::string_view digits = text->substr(0, n);
  text->remove_prefix(n);
  return digits;
}

/// Whether TOML reads this spelling as the number it is (".5", "1.", "007" and 2^64 it does not).
bool isTomlNumber(const Rational& value, std::string_view text) {
  constexpr std::size_t kMostCharacters = 100;  // toml++ looks 127 ahead to tell what a value is
  if (text.size() > kMostCharacters) return false;
  if (!text.empty() && text.front() == '-') text.remove_prefix(1);
  const std::string_view whole = takeDigits(&text);
  if (whole.empty() || (whole.size() > 1 && whole.front() == '0')) return false;
  const auto fits = [](const Integer& n) {
    return n >= std::numeric_limits<long long>::min() && n <= std::numeric_limits<long long>::max();
  };
  if (text.empty()) return fits(numerator(value));
  if (text.front() == '.') {
    text.remove_prefix(1);
    if (takeDigits(&text).empty()) return false;
  }
  if (!text.empty() && (text.front() == 'e' || text.front() == 'E')) {
    text.remove_prefix(1);
    if (!text.empty() && (text.front() == '+' || text.front() == '-')) text.remove_prefix(1);
    takeDigits(&text);
  }
  return text.empty();
}

std::string number(const Number& n) {
  const std::string text = n.text();
  const bool is_negative = n.kind() == Expression::Kind::kNegate;
  const Number& magnitude = is_negative ? n.left() : n;
  const bool is_literal = magnitude.kind() == Expression::Kind::kNumber;
  return is_literal && isTomlNumber(magnitude.number(), text) ? text : quoted(text);
}

template <typename Numbers>
std::string array(const Numbers& numbers) {
  std::string result;
  for (const Number& n : numbers) result += (result.empty() ? "" : ", ") + number(n);
  return "[" + result + "]";
}

template <typename Numbers>
bool allZero(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(),
                     [](const Number& n) { return n.isLiteralZero(); });
}

bool isLiteral(const Number& n, int value) {
  return n.kind() == Expression::Kind::kNumber && n.number() == value;
}

/// Collects "key = value" lines, leaving out defaults.
class Lines {
 public:
  void raw(const std::string& line) { text_ += line + '\n'; }
  void value(const std::string& key, const std::string& value) { raw(key + " = " + value); }
  void string(const std::string& key, const std::string& value) {
    if (!value.empty()) this->value(key, quoted(value));
  }
  void scalar(const std::string& key, const Number& n, int otherwise = 0) {
    if (!isLiteral(n, otherwise)) value(key, number(n));
  }
  template <typename Numbers>
  void list(const std::string& key, const Numbers& numbers) {
    if (!allZero(numbers)) value(key, array(numbers));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

using Cells = std::vector<std::pair<const char*, const Number*>>;

/// "{ a = 1, d = 2 }": an inline table of what is not zero, after `first`.
std::string inlineTable(std::string first, const Cells& cells) {
  for (const auto& [key, n] : cells) {
    if (n->isLiteralZero()) continue;
    first += (first.empty() ? "" : ", ") + std::string(key) + " = " + number(*n);
  }
  return first.empty() ? "{}" : "{ " + first + " }";
}

void writeInertia(const MassProperties& p, Lines* lines) {
  lines->scalar("mass", p.mass);
  lines->list("com", p.com);
  std::string first;
  if (p.about == MassProperties::About::kLinkOrigin) first = "about = \"origin\"";
  if (!allZero(p.rpy)) first += (first.empty() ? "rpy = " : ", rpy = ") + array(p.rpy);
  const std::string table = inlineTable(
      first,
      {{"xx", &p.xx}, {"yy", &p.yy}, {"zz", &p.zz}, {"xy", &p.xy}, {"xz", &p.xz}, {"yz", &p.yz}});
  if (table != "{}") lines->value("inertia", table);
}

void writePlacement(const Placement& p, Lines* lines) {
  if (p.convention == Placement::Convention::kXyzRpy) {
    lines->list("xyz", p.xyz);
    lines->list("rpy", p.rpy);
    return;
  }
  const bool is_dh = p.convention == Placement::Convention::kDh;
  lines->value(
      is_dh ? "dh" : "mdh",
      inlineTable("", {{"a", &p.a}, {"alpha", &p.alpha}, {"d", &p.d}, {"theta", &p.theta}}));
}

std::string inlineAttachment(const Attachment& at, const Mechanism& mechanism) {
  std::string text = "{ link = " + quoted(mechanism.links[static_cast<std::size_t>(at.link)].name);
  if (!allZero(at.xyz)) text += ", xyz = " + array(at.xyz);
  if (!allZero(at.rpy)) text += ", rpy = " + array(at.rpy);
  return text + " }";
}

/// Closures and springs without a name of their own are called by their place.
template <typename Part>
void writeEnds(const Part& part, std::size_t index, const Mechanism& mechanism, Lines* lines) {
  if (part.name != std::to_string(index + 1)) lines->value("name", quoted(part.name));
  lines->value("a", inlineAttachment(part.a, mechanism));
  lines->value("b", inlineAttachment(part.b, mechanism));
}

std::string inlineRotors(const std::vector<Rotor>& rotors) {
  std::string all;
  for (const Rotor& rotor : rotors) {
    all += (all.empty() ? "{ inertia = " : ", { inertia = ") + number(rotor.inertia) +
           ", ratio = " + array(rotor.ratio);
    if (rotor.axis) all += ", axis = " + array(*rotor.axis);
    all += " }";
  }
  return "[" + all + "]";
}

void writeJoint(const Link& link, Lines* lines) {
  const Joint& joint = link.joint;
  lines->raw("");
  lines->raw("[link.joint]");
  if (joint.name != link.name) lines->value("name", quoted(joint.name));
  lines->value("kind", quoted(name(joint.kind)));
  const bool is_z =
      isLiteral(joint.axis[0], 0) && isLiteral(joint.axis[1], 0) && isLiteral(joint.axis[2], 1);
  if (!is_z) lines->value("axis", array(joint.axis));
  if (joint.kind == JointKind::kHelical) lines->value("pitch", number(joint.pitch));
  writePlacement(joint.placement, lines);
  lines->scalar("rotor_inertia", joint.rotor_inertia);
  lines->scalar("gear_ratio", joint.gear_ratio, 1);
  if (joint.gyroscopic) lines->value("gyroscopic", "true");
  if (!joint.rotors.empty()) lines->value("rotors", inlineRotors(joint.rotors));
  lines->scalar("stiffness", joint.stiffness);
  lines->scalar("rest", joint.rest);
  if (!joint.motion.empty()) lines->value("motion", array(joint.motion));
  if (joint.mimic) {
    std::string table = "joint = " + quoted(joint.mimic->joint);
    if (!isLiteral(joint.mimic->multiplier, 1))
      table += ", multiplier = " + number(joint.mimic->multiplier);
    lines->value("mimic", inlineTable(table, {{"offset", &joint.mimic->offset}}));
  }
  const Friction& friction = joint.friction;
  if (friction.isNone()) return;
  std::string table = inlineTable("", {{"viscous", &friction.viscous}});
  if (friction.isCoulomb()) {
    const std::string positive = number(friction.positive), negative = number(friction.negative);
    table = inlineTable(
        "coulomb = " + (positive == negative ? positive
                                             : inlineTable("", {{"positive", &friction.positive},
                                                                {"negative", &friction.negative}})),
        {{"viscous", &friction.viscous}});
  }
  lines->value("friction", table);
}

}  // namespace

std::string writeSceneToml(const Scene& scene) {
  const Mechanism& mechanism = scene.mechanism;
  Lines lines;
  lines.string("title", scene.title);
  lines.string("source", scene.source);
  if (mechanism.has_gravity) lines.value("gravity", array(mechanism.gravity));
  if (!mechanism.parameters.empty()) lines.raw("\n[parameters]");
  for (const Parameter& p : mechanism.parameters) lines.value(p.name, number(p.value));
  for (const Link& link : mechanism.links) {
    lines.raw("\n[[link]]");
    lines.value("name", quoted(link.name));
    if (link.parent >= 0) {
      const Link& parent = mechanism.links[static_cast<std::size_t>(link.parent)];
      lines.value("parent", quoted(parent.name));
    }
    writeInertia(link.inertia, &lines);
    if (link.parent >= 0) writeJoint(link, &lines);
  }
  for (const Wrench& wrench : mechanism.wrenches) {
    lines.raw("\n[[wrench]]");
    lines.value("link", quoted(mechanism.links[static_cast<std::size_t>(wrench.link)].name));
    lines.list("force", wrench.force);
    lines.list("moment", wrench.moment);
    lines.list("at", wrench.at);
    if (wrench.axes == Wrench::Axes::kWorld) lines.value("axes", "\"world\"");
  }
  for (std::size_t i = 0; i < mechanism.closures.size(); ++i) {
    lines.raw("\n[[closure]]");
    lines.value("kind", quoted(name(mechanism.closures[i].kind)));
    writeEnds(mechanism.closures[i], i, mechanism, &lines);
    if (mechanism.closures[i].kind == ClosureKind::kDistance)
      lines.value("length", number(mechanism.closures[i].length));
    if (mechanism.closures[i].kind == ClosureKind::kRolling)
      lines.value("radius", number(mechanism.closures[i].length));
  }
  for (std::size_t i = 0; i < mechanism.springs.size(); ++i) {
    const Spring& spring = mechanism.springs[i];
    lines.raw("\n[[spring]]");
    writeEnds(spring, i, mechanism, &lines);
    lines.scalar("stiffness", spring.stiffness);
    lines.scalar("rest", spring.rest);
    lines.scalar("damping", spring.damping);
  }
  for (std::size_t i = 0; i < mechanism.acceleration_constraints.size(); ++i) {
    const AccelerationConstraint& held = mechanism.acceleration_constraints[i];
    lines.raw("\n[[acceleration_constraint]]");
    if (held.name != std::to_string(i + 1)) lines.value("name", quoted(held.name));
    lines.value("link", quoted(mechanism.links[static_cast<std::size_t>(held.link)].name));
    lines.list("at", held.at);
    lines.list("direction", held.direction);
    lines.list("rotation", held.rotation);
    if (held.axes == AccelerationConstraint::Axes::kLink) lines.value("axes", "\"link\"");
    lines.scalar("value", held.value);
    lines.scalar("compliance", held.compliance);
  }
  const auto given = [&mechanism](const std::vector<Number>& all) {
    if (!mechanism.hasMimics()) return array(all);
    std::vector<Number> some;
    for (const int slot : givenSlots(mechanism))
      some.push_back(all[static_cast<std::size_t>(slot)]);
    return array(some);
  };
  const std::string q = given(scene.start_q);
  const bool at_rest = q == given(mechanism.restPosition());
  if (!at_rest || !allZero(scene.start_qd)) lines.raw("\n[start]");
  if (!at_rest) lines.value("q", q);
  lines.list("qd", scene.start_qd);
  return lines.text();
}

std::string writeEnvelope(const Scene& scene, const std::vector<JointRanges>& ranges) {
  if (ranges.empty()) return "";
  std::string text = "\n[envelope]\n";
  const std::vector<std::string> labels = scene.mechanism.rateLabels();
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    const auto pair = [](const Range& r) { return fmt::format("[{}, {}]", r.low, r.high); };
    text += fmt::format("{} = {{ q = {}, qd = {}, qdd = {}{} }}\n", quoted(labels[k]),
                        pair(ranges[k].q), pair(ranges[k].qd), pair(ranges[k].qdd),
                        ranges[k].tau ? ", tau = " + pair(*ranges[k].tau) : std::string());
  }
  return text;
}

}  // namespace dynwitness::scene
