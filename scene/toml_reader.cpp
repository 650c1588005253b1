// SPDX-License-Identifier: GPL-3.0-or-later
// Reads TOML scenes (data/scenes/README.md).
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "scene/arrange.hpp"
#include "scene/changes.hpp"
#include "scene/envelope.hpp"
#include "scene/faults.hpp"
#include "scene/inertia_need.hpp"
#include "scene/mimic.hpp"
#include "scene/mjcf.hpp"
#include "scene/nearest_name.hpp"
#include "scene/scene.hpp"
#include "scene/text_file.hpp"
#include "scene/toml_file.hpp"
#include "scene/urdf.hpp"
#include "scene/words.hpp"

namespace dynwitness::scene {
namespace {

constexpr std::string_view kTables[] = {"title",      "source",   "gravity",
                                        "parameters", "link",     "wrench",
                                        "closure",    "spring",   "acceleration_constraint",
                                        "start",      "envelope", "like"};

/** The tables of a scene. toml++ says of [[links]] nothing but that the [link.joint] below it, the
    second, is there already; who reads that does not see why. */
toml::table tablesOf(const std::string& content, const std::string& file) {
  try {
    return parsedToml(content, file);
  } catch (const InputError& error) {
    if (std::string_view(error.what()).find("redefine") == std::string_view::npos) throw;
    std::istringstream lines(content);
    int number = 1;
    for (std::string line; std::getline(lines, line); ++number) {
      const std::string_view header = trimmed(line);
      if (header.substr(0, 2) != "[[") continue;
      const std::string name(trimmed(header.substr(2, header.find_first_of(".]", 2) - 2)));
      if (std::find(std::begin(kTables), std::end(kTables), name) != std::end(kTables)) continue;
      throw InputError({file, number},
                       "scene: unknown table [[" + name + "]]" +
                           didYouMean(name, {std::begin(kTables), std::end(kTables)}));
    }
    throw;
  }
}

class TomlReader : TomlFile {
 public:
  TomlReader(const std::string& text, const std::string& file) : TomlFile(file) {
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines_.push_back(line);
  }

  Scene read(const toml::table& top);
  /// Values of parameters that another file gives: these take the place of the file's own.
  void replace(const std::vector<Parameter>& parameters) { replaced_ = parameters; }

 private:
  std::string literal(const toml::node& node) const;
  Number expression(const toml::node& node, const std::string& what, bool of_time = false) const;
  Number number(const toml::node& node, const std::string& what) const;
  Number optionalNumber(const toml::table& table, const std::string& what, const std::string& key,
                        Number otherwise = 0) const;
  std::vector<Number> numbers(const toml::node& node, const std::string& what,
                              std::size_t count) const;
  Vector vector(const toml::node& node, const std::string& what) const;
  Vector optionalVector(const toml::table& table, const std::string& what, const std::string& key,
                        const Vector& otherwise = {}) const;

  std::vector<Parameter> parsedParameters(const toml::node& node) const;
  void define(std::vector<Parameter> parameters);
  NamedLink readLink(const toml::table& table) const;
  Joint readJoint(const toml::table& table, const std::string& link) const;
  JointKind readJointKind(const toml::table& table, const std::string& what) const;
  void checkJointKeys(const toml::table& table, const std::string& what, JointKind kind) const;
  Placement readPlacement(const toml::table& table, const std::string& what) const;
  std::vector<Rotor> readRotors(const toml::node& node, const std::string& what, int rates) const;
  Friction readFriction(const toml::table& table, const std::string& what) const;
  Mimic readMimic(const toml::table& table, const std::string& what) const;
  void readInertia(const toml::table& table, const std::string& what,
                   MassProperties* inertia) const;
  /// A link of this scene by name, as an index.
  int linkNamed(const toml::node& node, const std::string& what) const;
  Wrench readWrench(const toml::table& table) const;
  Attachment readAttachment(const toml::table& table, const std::string& what,
                            const std::string& key, bool has_axes) const;
  Closure readClosure(const toml::table& table, std::size_t index) const;
  Spring readSpring(const toml::table& table, std::size_t index) const;
  std::vector<Expression> readMotion(const toml::node& node, const std::string& what,
                                     int count) const;
  AccelerationConstraint readAccelerationConstraint(const toml::table& table,
                                                    std::size_t index) const;
  void readStart(const toml::node& node);
  std::filesystem::path likeFile(const toml::node& node) const;
  void readLike(const toml::node& node, const toml::table& top);
  void readSettings(const toml::node& node);
  void readParts(const toml::table& top);
  void readTree(const toml::table& top);
  void readLoads(const toml::table& top);

  std::vector<std::string> lines_;
  mutable toml::source_index columns_of_ = 0;  ///< the line of:
  mutable std::vector<std::size_t>
      columns_;  ///< where its characters begin; toml++ counts code points
  Scene scene_;
  std::unordered_map<std::string, int> link_index_;
  ParameterValues values_;
  std::vector<Parameter> replaced_;
  mutable Faults faults_;  ///< of parts that others do not hang on
};

// ------------------------------------------------------------------------------------- numbers

/// A number as the file spells it: toml++ has rounded its value to a double already.
std::string TomlReader::literal(const toml::node& node) const {
  const toml::source_position begin = node.source().begin;
  const std::string& line = lines_.at(begin.line - 1);
  if (columns_of_ != begin.line) {
    columns_of_ = begin.line;
    columns_.clear();
    for (std::size_t i = 0; i < line.size(); ++i)
      if ((static_cast<unsigned char>(line[i]) & 0xC0) != 0x80) columns_.push_back(i);
  }
  std::size_t at = columns_.at(begin.column - 1);
  std::string result;
  for (; at < line.size(); ++at) {
    const char c = line[at];
    const bool part = (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-' || c == 'e' ||
                      c == 'E' || c == '_';
    if (!part) break;
    if (c != '_') result += c;
  }
  return result;
}

/// What "1 kg" and "9.81 m/s^2" have to be told, and no other fault.
std::string remarkOnUnits(const std::string& text) {
  const std::size_t word = text.find_first_not_of("0123456789.eE+- ");
  if (word == 0 || word == std::string::npos ||
      std::isalpha(static_cast<unsigned char>(text[word])) == 0)
    return "";
  const std::size_t end = text.find_last_not_of(' ', word - 1);
  const bool is_number =
      end != std::string::npos && std::isdigit(static_cast<unsigned char>(text[end])) != 0;
  return is_number ? "; numbers have no units here: all is in m, kg, s, rad" : "";
}

/// An expression whose parameters are not looked up yet.
Number TomlReader::expression(const toml::node& node, const std::string& what, bool of_time) const {
  const auto read = [&](const std::string& text) {
    try {
      return of_time ? Expression::parseOfTime(text) : Expression::parse(text);
    } catch (const InputError& error) {
      throw InputError(where(node), what + ": " + error.what() + remarkOnUnits(text));
    }
  };
  if (const auto* text = node.as_string()) return read(text->get());
  if (const auto* integer = node.as_integer()) return read(std::to_string(integer->get()));
  if (const auto* real = node.as_floating_point()) {
    if (!std::isfinite(real->get())) {
      throw InputError(where(node), what + ": not finite, allowed: a finite number");
    }
    Number result = read(literal(node));
    if (exactValue(result, {}).toDouble() != real->get()) {
      throw std::logic_error("TomlReader: lost the spelling of a number, " + where(node).text());
    }
    return result;
  }
  wrongType(node, what, "a number or a string with an expression");
}

Number TomlReader::number(const toml::node& node, const std::string& what) const {
  Number result = expression(node, what);
  try {
    exactValue(result, values_);
  } catch (const InputError& error) {
    throw InputError(where(node), what + ": " + error.what());
  }
  return result;
}

Number TomlReader::optionalNumber(const toml::table& table, const std::string& what,
                                  const std::string& key, Number otherwise) const {
  const toml::node* node = table.get(key);
  return node ? number(*node, what + ": " + key) : std::move(otherwise);
}

std::vector<Number> TomlReader::numbers(const toml::node& node, const std::string& what,
                                        std::size_t count) const {
  const std::string allowed = "an array of " + std::to_string(count) + " numbers";
  if (!node.is_array()) wrongType(node, what, allowed);
  const toml::array& array = *node.as_array();
  if (array.size() != count) {
    throw InputError(where(node), what + ": an array of " + std::to_string(array.size()) +
                                      ", allowed: " + allowed);
  }
  std::vector<Number> result;
  for (const toml::node& element : array) result.push_back(number(element, what));
  return result;
}

Vector TomlReader::vector(const toml::node& node, const std::string& what) const {
  const std::vector<Number> v = numbers(node, what, 3);
  return {v[0], v[1], v[2]};
}

Vector TomlReader::optionalVector(const toml::table& table, const std::string& what,
                                  const std::string& key, const Vector& otherwise) const {
  const toml::node* node = table.get(key);
  return node ? vector(*node, what + ": " + key) : otherwise;
}

// ------------------------------------------------------------------------- the parts of a scene

/// The keys of a table in the file's order: toml++ keeps them sorted.
std::vector<const toml::key*> inFileOrder(const toml::table& table) {
  std::vector<const toml::key*> keys;
  for (const auto& entry : table) keys.push_back(&entry.first);
  std::sort(keys.begin(), keys.end(), [](const toml::key* a, const toml::key* b) {
    const toml::source_position p = a->source().begin, q = b->source().begin;
    return p.line != q.line ? p.line < q.line : p.column < q.column;
  });
  return keys;
}

/// In their order, which decides what may use what.
std::vector<Parameter> TomlReader::parsedParameters(const toml::node& node) const {
  std::vector<Parameter> parameters;
  const toml::table& table = asTable(node, "parameters");
  for (const toml::key* key : inFileOrder(table)) {
    const std::string name(key->str());
    const toml::node& value = *table.get(name);
    parameters.push_back({name, 1, where(value)});  // as if it were 1 where something is wrong
    faults_.collect([&] {
      if (!isParameterName(name))
        throw InputError(where(key->source()),
                         "parameter \"" + name +
                             "\": not a name, allowed: letters, digits and _, not starting with a "
                             "digit, and not pi, inf or nan");
      parameters.back().value = expression(value, "parameter \"" + name + '"');
    });
  }
  return parameters;
}

void TomlReader::define(std::vector<Parameter> parameters) {
  for (Parameter& parameter : parameters)
    for (const Parameter& other : replaced_)
      if (other.name == parameter.name) parameter = other;
  std::map<std::string, SourceLocation> definitions;
  for (const Parameter& parameter : parameters) definitions[parameter.name] = parameter.where;
  const auto require = [&](const Parameter& parameter) {
    const std::string& name = parameter.name;
    for (const std::string& used : parameter.value.parameters()) {
      if (used == name) {
        throw InputError(parameter.where, "parameter \"" + name + "\": is defined by itself");
      }
      if (values_.count(used) == 0 && definitions.count(used) > 0) {
        throw InputError(parameter.where, "parameter \"" + name + "\": uses \"" + used +
                                              "\" before it is defined (" +
                                              definitions[used].text() + ")");
      }
    }
    try {
      values_[name] = exactValue(parameter.value, values_);
    } catch (const InputError& error) {
      throw InputError(parameter.where, "parameter \"" + name + "\": " + error.what());
    }
  };
  for (const Parameter& parameter : parameters) {
    faults_.collect([&] { require(parameter); });
    values_.emplace(parameter.name, Exact{1, 0});  // so that a fault is told once
    scene_.mechanism.parameters.push_back(parameter);
  }
}

NamedLink TomlReader::readLink(const toml::table& table) const {
  NamedLink named;
  Link& link = named.link;
  link.where = where(table);
  link.name = string(required(table, "link", "name", "a string"), "link: name");
  const std::string what = "link \"" + link.name + '"';
  faults_.collect([&] {
    checkKeys(table, what, {"name", "parent", "mass", "com", "inertia", "joint"});
  });
  faults_.collect([&] { link.inertia.mass = optionalNumber(table, what, "mass"); });
  faults_.collect([&] { link.inertia.com = optionalVector(table, what, "com"); });
  faults_.collect([&] {
    if (const toml::node* inertia = table.get("inertia"))
      readInertia(asTable(*inertia, what + ": inertia"), what + ": inertia", &link.inertia);
  });
  const toml::node* joint = table.get("joint");
  if (const toml::node* parent = table.get("parent")) {
    named.parent = string(*parent, what + ": parent");
    named.parent_where = where(*parent);
    if (!joint) throw InputError(link.where, what + ": has a parent, but no [link.joint]");
    faults_.collect([&] { link.joint = readJoint(asTable(*joint, what + ": joint"), link.name); });
  } else if (joint) {
    throw InputError(where(*joint), what + ": has a joint, but no parent");
  }
  return named;
}

JointKind TomlReader::readJointKind(const toml::table& table, const std::string& what) const {
  std::string allowed;
  for (const JointKind k : kAllJointKinds)
    allowed += (allowed.empty() ? "" : ", ") + std::string(name(k));
  const toml::node& node = required(table, what, "kind", allowed);
  const std::string kind = string(node, what + ": kind");
  for (const JointKind k : kAllJointKinds) {
    if (kind == name(k)) return k;
  }
  std::vector<std::string> kinds;
  for (const JointKind k : kAllJointKinds) kinds.emplace_back(name(k));
  throw InputError(where(node), what + ": kind is \"" + kind + '"' + didYouMean(kind, kinds) +
                                    ", allowed: " + allowed);
}

void TomlReader::checkJointKeys(const toml::table& table, const std::string& what,
                                JointKind kind) const {
  const std::string of_kind = what + " (" + name(kind) + ")";
  Keys allowed = {"name", "kind", "xyz", "rpy"};
  const auto allow = [&](std::initializer_list<const char*> keys) {
    allowed.insert(allowed.end(), keys.begin(), keys.end());
  };
  switch (kind) {
    case JointKind::kFixed:
      allow({"dh", "mdh"});
      break;
    case JointKind::kHelical:
      allow({"pitch"});
      [[fallthrough]];
    case JointKind::kRevolute:
    case JointKind::kPrismatic:
      allow({"axis", "dh", "mdh", "rotor_inertia", "gear_ratio", "gyroscopic", "stiffness", "rest",
             "friction", "mimic"});
      break;
    case JointKind::kCylindrical:
      allow({"axis", "dh", "mdh"});
      break;
    case JointKind::kPlanar:
      allow({"axis"});
      break;
    case JointKind::kUniversal:
    case JointKind::kSpherical:
    case JointKind::kFloating:
      break;
  }
  if (degreesOfFreedom(kind) > 0 && ratesArePositionDerivatives(kind)) allow({"motion"});
  if (degreesOfFreedom(kind) > 1) allow({"rotors"});
  if (degreesOfFreedom(kind) > 1) {
    for (const char* key :
         {"rotor_inertia", "gear_ratio", "gyroscopic", "stiffness", "rest", "friction", "mimic"}) {
      if (const toml::node* node = table.get(key))
        throw InputError(where(*node),
                         of_kind + ": has " + key +
                             ", allowed: only with revolute, prismatic and helical "
                             "joints, which have one position to measure (rotors of "
                             "this joint: rotors = [{ inertia = J, ratio = [...] }])");
    }
  }
  checkKeys(table, of_kind, allowed);
}

Joint TomlReader::readJoint(const toml::table& table, const std::string& link) const {
  Joint joint;
  const toml::node* name_node = table.get("name");
  joint.name = name_node ? string(*name_node, "link \"" + link + "\": joint name") : link;
  const std::string what = "joint \"" + joint.name + '"';
  if (joint.name.empty())
    throw InputError(name_node ? where(*name_node) : where(table), what + ": empty name");
  bool has_kind = false;
  faults_.collect([&] {
    joint.kind = readJointKind(table, what);
    has_kind = true;
  });
  faults_.collect([&] { joint.placement = readPlacement(table, what); });
  faults_.collect([&] { joint.axis = optionalVector(table, what, "axis", joint.axis); });
  if (!has_kind) return joint;  // what else it may have hangs on that
  faults_.collect([&] { checkJointKeys(table, what, joint.kind); });
  if (joint.kind == JointKind::kHelical)
    joint.pitch =
        number(required(table, what, "pitch", "the advance a radian, m/rad"), what + ": pitch");
  joint.rotor_inertia = optionalNumber(table, what, "rotor_inertia");
  joint.gear_ratio = optionalNumber(table, what, "gear_ratio", 1);
  joint.stiffness = optionalNumber(table, what, "stiffness");
  joint.rest = optionalNumber(table, what, "rest");
  if (const toml::node* gyroscopic = table.get("gyroscopic")) {
    if (!gyroscopic->is_boolean()) wrongType(*gyroscopic, what + ": gyroscopic", "true, false");
    joint.gyroscopic = gyroscopic->as_boolean()->get();
  }
  if (const toml::node* rotors = table.get("rotors"))
    joint.rotors = readRotors(*rotors, what + ": rotors", degreesOfFreedom(joint.kind));
  if (const toml::node* friction = table.get("friction"))
    joint.friction = readFriction(asTable(*friction, what + ": friction"), what + ": friction");
  if (const toml::node* mimic = table.get("mimic"))
    joint.mimic = readMimic(asTable(*mimic, what + ": mimic"), what + ": mimic");
  if (const toml::node* motion = table.get("motion"))
    joint.motion = readMotion(*motion, what + ": motion", degreesOfFreedom(joint.kind));
  return joint;
}

std::vector<Rotor> TomlReader::readRotors(const toml::node& node, const std::string& what,
                                          int rates) const {
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty())
    wrongType(node, what, "an array of tables { inertia, ratio, axis }");
  std::vector<Rotor> rotors;
  for (const toml::node& element : *array) {
    const std::string one = what + ": rotor " + std::to_string(rotors.size() + 1);
    const toml::table& table = asTable(element, one);
    checkKeys(table, one, {"inertia", "ratio", "axis"});
    Rotor rotor;
    rotor.inertia =
        number(required(table, one, "inertia", "a number above zero, kg m^2"), one + ": inertia");
    rotor.ratio = numbers(required(table, one, "ratio", "one number a rate of the joint"),
                          one + ": ratio", static_cast<std::size_t>(rates));
    if (const toml::node* axis = table.get("axis")) rotor.axis = vector(*axis, one + ": axis");
    rotors.push_back(std::move(rotor));
  }
  return rotors;
}

Friction TomlReader::readFriction(const toml::table& table, const std::string& what) const {
  checkKeys(table, what, {"viscous", "coulomb"});
  Friction friction;
  friction.viscous = optionalNumber(table, what, "viscous");
  const toml::node* coulomb = table.get("coulomb");
  if (coulomb == nullptr) return friction;
  if (!coulomb->is_table()) {
    friction.positive = friction.negative = number(*coulomb, what + ": coulomb");
    return friction;
  }
  const toml::table& sides = *coulomb->as_table();
  checkKeys(sides, what + ": coulomb", {"positive", "negative"});
  friction.positive = optionalNumber(sides, what + ": coulomb", "positive");
  friction.negative = optionalNumber(sides, what + ": coulomb", "negative");
  return friction;
}

Mimic TomlReader::readMimic(const toml::table& table, const std::string& what) const {
  checkKeys(table, what, {"joint", "multiplier", "offset"});
  Mimic mimic;
  mimic.joint =
      string(required(table, what, "joint", "the name of another joint"), what + ": joint");
  mimic.multiplier = optionalNumber(table, what, "multiplier", 1);
  mimic.offset = optionalNumber(table, what, "offset");
  return mimic;
}

Placement TomlReader::readPlacement(const toml::table& table, const std::string& what) const {
  Placement p;
  p.xyz = optionalVector(table, what, "xyz");
  p.rpy = optionalVector(table, what, "rpy");
  for (const char* convention : {"dh", "mdh"}) {
    const toml::node* node = table.get(convention);
    if (!node) continue;
    for (const char* other : {"xyz", "rpy", "axis", "mdh"}) {
      if (std::string(other) == convention || table.get(other) == nullptr) continue;
      throw InputError(where(*node), what + ": has both " + convention + " and " + other +
                                         ", allowed: xyz, rpy and axis, or dh, or mdh");
    }
    const std::string row = what + ": " + convention;
    const toml::table& cells = asTable(*node, row);
    checkKeys(cells, row, {"a", "alpha", "d", "theta"});
    p.convention =
        std::string(convention) == "dh" ? Placement::Convention::kDh : Placement::Convention::kMdh;
    p.a = optionalNumber(cells, row, "a");
    p.alpha = optionalNumber(cells, row, "alpha");
    p.d = optionalNumber(cells, row, "d");
    p.theta = optionalNumber(cells, row, "theta");
  }
  return p;
}

void TomlReader::readInertia(const toml::table& table, const std::string& what,
                             MassProperties* inertia) const {
  checkKeys(table, what, {"about", "rpy", "xx", "yy", "zz", "xy", "xz", "yz"});
  if (const toml::node* about = table.get("about")) {
    const std::string point = string(*about, what + ": about");
    if (point != "com" && point != "origin") {
      throw InputError(where(*about),
                       what + ": about is \"" + point + "\", allowed: \"com\", \"origin\"");
    }
    inertia->about =
        point == "com" ? MassProperties::About::kCenterOfMass : MassProperties::About::kLinkOrigin;
  }
  inertia->rpy = optionalVector(table, what, "rpy");
  inertia->xx = optionalNumber(table, what, "xx");
  inertia->yy = optionalNumber(table, what, "yy");
  inertia->zz = optionalNumber(table, what, "zz");
  inertia->xy = optionalNumber(table, what, "xy");
  inertia->xz = optionalNumber(table, what, "xz");
  inertia->yz = optionalNumber(table, what, "yz");
}

int TomlReader::linkNamed(const toml::node& node, const std::string& what) const {
  const std::string name = string(node, what + ": link");
  const auto found = link_index_.find(name);
  if (found == link_index_.end()) {
    throw InputError(where(node), what + ": \"" + name + "\" is not a link of this scene");
  }
  return found->second;
}

Wrench TomlReader::readWrench(const toml::table& table) const {
  Wrench wrench;
  checkKeys(table, "wrench", {"link", "force", "moment", "at", "axes"});
  const toml::node& node = required(table, "wrench", "link", "the name of a link");
  const std::string link = string(node, "wrench: link");
  const std::string what = "wrench on \"" + link + '"';
  wrench.link = linkNamed(node, "wrench");
  wrench.force = optionalVector(table, what, "force");
  wrench.moment = optionalVector(table, what, "moment");
  wrench.at = optionalVector(table, what, "at");
  if (const toml::node* axes = table.get("axes")) {
    const std::string which = string(*axes, what + ": axes");
    if (which != "link" && which != "world") {
      throw InputError(where(*axes),
                       what + ": axes is \"" + which + "\", allowed: \"link\", \"world\"");
    }
    wrench.axes = which == "link" ? Wrench::Axes::kLink : Wrench::Axes::kWorld;
  }
  return wrench;
}

Attachment TomlReader::readAttachment(const toml::table& table, const std::string& what,
                                      const std::string& key, bool has_axes) const {
  const std::string allowed =
      has_axes ? "{ link = \"name\", xyz = [..], rpy = [..] }" : "{ link = \"name\", xyz = [..] }";
  const std::string whole = what + ": " + key;
  const toml::table& given = asTable(required(table, what, key, allowed), whole);
  if (has_axes) {
    checkKeys(given, whole, {"link", "xyz", "rpy"});
  } else {
    checkKeys(given, whole, {"link", "xyz"});
  }
  Attachment attachment;
  attachment.link = linkNamed(required(given, whole, "link", "the name of a link"), whole);
  attachment.xyz = optionalVector(given, whole, "xyz");
  if (has_axes) attachment.rpy = optionalVector(given, whole, "rpy");
  return attachment;
}

Closure TomlReader::readClosure(const toml::table& table, std::size_t index) const {
  Closure closure;
  closure.where = where(table);
  const toml::node* name_node = table.get("name");
  closure.name = name_node ? string(*name_node, "closure: name") : std::to_string(index + 1);
  const std::string what = "closure \"" + closure.name + '"';
  checkKeys(table, what, {"name", "kind", "a", "b", "length", "radius"});
  const std::string allowed = "distance, plane, planar_point, point, hinge, weld, skate, rolling";
  const toml::node& node = required(table, what, "kind", allowed);
  const std::string kind = string(node, what + ": kind");
  bool known = false;
  for (const ClosureKind k :
       {ClosureKind::kDistance, ClosureKind::kPlane, ClosureKind::kPlanarPoint, ClosureKind::kPoint,
        ClosureKind::kHinge, ClosureKind::kWeld, ClosureKind::kSkate, ClosureKind::kRolling}) {
    if (kind != dynwitness::scene::name(k)) continue;
    closure.kind = k;
    known = true;
  }
  if (!known) {
    throw InputError(where(node), what + ": kind is \"" + kind + "\", allowed: " + allowed);
  }
  closure.a = readAttachment(table, what, "a", true);
  closure.b = readAttachment(table, what, "b", true);
  for (const auto& [key, of] :
       {std::pair{"length", ClosureKind::kDistance}, std::pair{"radius", ClosureKind::kRolling}}) {
    if (closure.kind == of)
      closure.length = number(required(table, what, key, "a length above zero"), what + ": " + key);
    else if (const toml::node* length = table.get(key))
      throw InputError(where(*length), what + ": a " + kind + " has no " + key +
                                           ", allowed: of a " + dynwitness::scene::name(of));
  }
  return closure;
}

Spring TomlReader::readSpring(const toml::table& table, std::size_t index) const {
  Spring spring;
  spring.where = where(table);
  const toml::node* name_node = table.get("name");
  spring.name = name_node ? string(*name_node, "spring: name") : std::to_string(index + 1);
  const std::string what = "spring \"" + spring.name + '"';
  checkKeys(table, what, {"name", "a", "b", "stiffness", "rest", "damping"});
  spring.a = readAttachment(table, what, "a", false);
  spring.b = readAttachment(table, what, "b", false);
  spring.stiffness = optionalNumber(table, what, "stiffness");
  spring.rest = optionalNumber(table, what, "rest");
  spring.damping = optionalNumber(table, what, "damping");
  return spring;
}

/// One function of time, or one a position of the joint.
std::vector<Expression> TomlReader::readMotion(const toml::node& node, const std::string& what,
                                               int count) const {
  std::vector<const toml::node*> given = {&node};
  if (const toml::array* array = node.as_array()) {
    given.clear();
    for (const toml::node& element : *array) given.push_back(&element);
  }
  if (static_cast<int>(given.size()) != count) {
    throw InputError(where(node), what + ": " + std::to_string(given.size()) +
                                      " functions of t, allowed: one a position of the joint, " +
                                      std::to_string(count));
  }
  std::vector<Expression> motion;
  for (const toml::node* element : given) {
    motion.push_back(expression(*element, what, true));
    for (const std::string& name : motion.back().parameters()) {
      if (values_.count(name) > 0) continue;
      throw InputError(where(*element), what + ": parameter \"" + name +
                                            "\" is not defined, allowed: t, pi and the parameters");
    }
  }
  return motion;
}

AccelerationConstraint TomlReader::readAccelerationConstraint(const toml::table& table,
                                                              std::size_t index) const {
  AccelerationConstraint held;
  held.where = where(table);
  const toml::node* name_node = table.get("name");
  held.name =
      name_node ? string(*name_node, "acceleration_constraint: name") : std::to_string(index + 1);
  const std::string what = "acceleration_constraint \"" + held.name + '"';
  checkKeys(table, what,
            {"name", "link", "at", "direction", "rotation", "axes", "value", "compliance"});
  held.link = linkNamed(required(table, what, "link", "the name of a link"), what);
  held.at = optionalVector(table, what, "at");
  held.direction = optionalVector(table, what, "direction");
  held.rotation = optionalVector(table, what, "rotation");
  held.value = optionalNumber(table, what, "value");
  held.compliance = optionalNumber(table, what, "compliance");
  if (const toml::node* axes = table.get("axes")) {
    const std::string which = string(*axes, what + ": axes");
    if (which != "link" && which != "world") {
      throw InputError(where(*axes),
                       what + ": axes is \"" + which + "\", allowed: \"link\", \"world\"");
    }
    held.axes = which == "link" ? AccelerationConstraint::Axes::kLink
                                : AccelerationConstraint::Axes::kWorld;
  }
  return held;
}

void TomlReader::readStart(const toml::node& node) {
  const toml::table& table = asTable(node, "start");
  checkKeys(table, "start", {"q", "qd"});
  const auto dof = static_cast<std::size_t>(scene_.mechanism.dof());
  const std::vector<int> given = givenSlots(scene_.mechanism);
  if (const toml::node* q = table.get("q")) {
    const std::vector<Number> read = numbers(*q, "start: q", given.size());
    scene_.start_q.resize(static_cast<std::size_t>(scene_.mechanism.positions()));
    for (std::size_t k = 0; k < given.size(); ++k)
      scene_.start_q[static_cast<std::size_t>(given[k])] = read[k];
    followLeaders(followers(scene_.mechanism), &scene_.start_q);
  }
  if (const toml::node* qd = table.get("qd")) scene_.start_qd = numbers(*qd, "start: qd", dof);
}

/// Of a scene that this one is like: a file, seen from this one's folder, with or without .toml; or
/// a bundled scene.
std::filesystem::path TomlReader::likeFile(const toml::node& node) const {
  const std::string name = string(node, "like");
  const std::filesystem::path folder = std::filesystem::path(file_).parent_path();
  for (const std::filesystem::path& file : {folder / name, folder / (name + ".toml")})
    if (!name.empty() && std::filesystem::is_regular_file(file)) return file;
  for (const std::filesystem::path& file : bundledScenes())
    if (file.stem() == name) return file;
  throw InputError(where(node), "like is \"" + name +
                                    "\", allowed: a TOML, URDF or MJCF file, seen from this "
                                    "file's folder, or the name of a bundled scene");
}

/// The scene of another file, some of which this one changes.
void TomlReader::readLike(const toml::node& node, const toml::table& top) {
  checkKeys(top, "a scene that is like another",
            {"title", "source", "like", "gravity", "base", "parameters", "set", "wrench", "closure",
             "spring", "acceleration_constraint", "start", "envelope"});
  const std::filesystem::path other = likeFile(node);
  std::vector<Parameter> given;
  if (const toml::node* parameters = top.get("parameters")) given = parsedParameters(*parameters);
  const std::string text = withoutMark(readTextFile(other, "a TOML, URDF or MJCF file"));
  if (looksLikeXml(text)) {
    // what it lacks may stand here
    scene_ = isMjcf(text) ? readSceneMjcf(text, other, InertiaNeed::kOfNoJoint)
                          : readUrdfAsWritten(text, other).scene;
  } else {
    const toml::table of_other = parsedToml(text, other.string());
    if (of_other.get("like")) {
      throw InputError(where(node), "like is \"" + string(node, "like") +
                                        "\", which is like a third scene itself, allowed: one "
                                        "that stands alone");
    }
    TomlReader reader(text, other.string());
    reader.replace(given);
    scene_ = reader.read(of_other);
  }
  values_ = scene_.mechanism.parameterValues();
  given.erase(std::remove_if(given.begin(), given.end(),
                             [&](const Parameter& p) { return values_.count(p.name) > 0; }),
              given.end());
  define(given);
}

/// [set]: the words of the command line's --set, each a number, a function or as many as it takes.
void TomlReader::readSettings(const toml::node& node) {
  const toml::table& table = asTable(node, "set");
  for (const toml::key* key : inFileOrder(table)) {
    const std::string name(key->str());
    const toml::node& value = *table.get(name);
    const ChangeAsGiven as_given{"set: \"" + name + "\"", where(value)};
    if (name.find(':') == std::string::npos)
      throw InputError(as_given.where, as_given.words +
                                           ": no number of a link or a joint, allowed: "
                                           "\"mass:LINK\" and the like; parameters stand in "
                                           "[parameters]");
    const auto textOf = [&](const toml::node& one) {
      return one.is_string() ? one.as_string()->get() : expression(one, as_given.words).text();
    };
    std::string text;
    if (const toml::array* array = value.as_array())
      for (const toml::node& element : *array) text += (text.empty() ? "" : ",") + textOf(element);
    else
      text = textOf(value);
    faults_.collect([&] { setNumber(scene_, name, text, as_given); });
  }
}

/// Links, gravity and what else the mechanism's tree is made of.
void TomlReader::readTree(const toml::table& top) {
  Mechanism& mechanism = scene_.mechanism;
  const bool is_like = top.get("like") != nullptr;
  if (const toml::node* parameters = top.get("parameters"); parameters && !is_like)
    define(parsedParameters(*parameters));
  if (const toml::node* settings = top.get("set"); settings && is_like) readSettings(*settings);
  if (const toml::node* base = top.get("base"); base && is_like) {
    const std::string word = string(*base, "base");
    setBase(scene_, word, {"base = \"" + word + "\"", where(*base)});
  }
  if (const toml::node* gravity = top.get("gravity")) {
    mechanism.has_gravity = true;
    faults_.collect([&] { mechanism.gravity = vector(*gravity, "gravity"); });
  }
  if (is_like) return;
  std::vector<NamedLink> links;
  for (const toml::table* table : tables(top, "link"))
    faults_.collect([&] { links.push_back(readLink(*table)); });
  // what is said of the tree hangs on all of them
  if (faults_.isEmpty()) mechanism.links = arrange(links, file_);
}

/// What acts on links.
void TomlReader::readLoads(const toml::table& top) {
  Mechanism& mechanism = scene_.mechanism;
  const auto each = [&](const char* key, const auto& read) {
    for (const toml::table* table : tables(top, key)) faults_.collect([&] { read(*table); });
  };
  each("wrench", [&](const toml::table& t) { mechanism.wrenches.push_back(readWrench(t)); });
  each("closure", [&](const toml::table& t) {
    mechanism.closures.push_back(readClosure(t, mechanism.closures.size()));
  });
  each("spring", [&](const toml::table& t) {
    mechanism.springs.push_back(readSpring(t, mechanism.springs.size()));
  });
  each("acceleration_constraint", [&](const toml::table& t) {
    mechanism.acceleration_constraints.push_back(
        readAccelerationConstraint(t, mechanism.acceleration_constraints.size()));
  });
}

void TomlReader::readParts(const toml::table& top) {
  const toml::node* like = top.get("like");
  const auto checkOwn = [&] { checkKeys(top, "scene", {std::begin(kTables), std::end(kTables)}); };
  if (like)
    readLike(*like, top);
  else
    faults_.collect(checkOwn);
  if (const std::string title = optionalString(top, "title"); !title.empty()) scene_.title = title;
  if (const std::string source = optionalString(top, "source"); !source.empty())
    scene_.source = source;
  readTree(top);
  if (!faults_.isEmpty()) return;
  Mechanism& mechanism = scene_.mechanism;
  for (const Link& link : mechanism.links)
    link_index_.emplace(link.name, static_cast<int>(link_index_.size()));
  readLoads(top);
  if (!like || top.get("start")) {
    scene_.start_q = mechanism.restPosition();
    scene_.start_qd.assign(static_cast<std::size_t>(mechanism.dof()), Number());
  }
  if (const toml::node* start = top.get("start")) faults_.collect([&] { readStart(*start); });
}

Scene TomlReader::read(const toml::table& top) {
  faults_.collect([&] { readParts(top); });
  faults_.raise();
  return std::move(scene_);
}

}  // namespace

Scene readSceneToml(const std::string& text, const std::filesystem::path& file) {
  return readSceneToml(text, file, InertiaNeed::kOfEachJoint);
}

Scene readSceneToml(const std::string& text, const std::filesystem::path& file, InertiaNeed need) {
  const std::string name = file.string();
  const std::string content = withoutMark(text);
  const toml::table top = tablesOf(content, name);
  Scene scene = TomlReader(content, name).read(top);
  scene.file = file;
  scene.name = file.stem().string();
  validate(scene, need);
  // whatever is asked, a range that is none is said
  if (top.contains("envelope")) envelopeOf(text, scene);
  return scene;
}

}  // namespace dynwitness::scene
