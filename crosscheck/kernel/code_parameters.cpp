// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/kernel/code_parameters.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "scene/units.hpp"

namespace dynwitness::crosscheck::kernel {
namespace {

using scene::Mechanism;
using scene::Number;
using scene::ParameterValues;

/// Text with the operators of an expression.
struct Text {
  std::string text;
  friend Text operator+(const Text& a, const Text& b) {
    return {"(" + a.text + "+" + b.text + ")"};
  }
  friend Text operator-(const Text& a, const Text& b) {
    return {"(" + a.text + "-" + b.text + ")"};
  }
  friend Text operator*(const Text& a, const Text& b) {
    return {"(" + a.text + "*" + b.text + ")"};
  }
  friend Text operator/(const Text& a, const Text& b) {
    return {"(" + a.text + "/" + b.text + ")"};
  }
  Text operator-() const { return {"(-" + text + ")"}; }
};
struct Substitution {
  const std::map<std::string, Number>& meaning;
  Text number(const scene::Rational& r) const { return {"(" + Number(r).text() + ")"}; }
  Text pi() const { return {"pi"}; }
  Text parameter(const std::string& name) const {
    const auto it = meaning.find(name);
    return {it == meaning.end() ? name : "(" + it->second.text() + ")"};
  }
};

Number substituted(const Number& number, const std::map<std::string, Number>& meaning) {
  const std::set<std::string> names = number.parameters();
  if (std::none_of(names.begin(), names.end(),
                   [&](const std::string& name) { return meaning.count(name) > 0; }))
    return number;
  return Number::parse(scene::evaluateIn<Text>(number, Substitution{meaning}).text);
}

Number valueOf(const scene::Exact& x) {
  return Number::parse("(" + Number(x.rational).text() + ")+(" + Number(x.pi_multiple).text() +
                       ")*pi");
}

/// A number, of what, and in which unit.
struct Place {
  Number* number;
  std::string word, owner, unit;  ///< "com_x", "link_2", "m"

  std::string name() const { return owner.empty() ? word : word + "_" + owner; }
  std::string what() const { return owner.empty() ? word : word + ":" + owner; }
};

void addVector(std::vector<Place>& places, scene::Vector& v, const std::string& word,
               const std::string& owner, const std::string& unit) {
  const std::string before = word.empty() ? "" : word + "_";
  const char* const axes[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) places.push_back({&v[k], before + axes[k], owner, unit});
}

void addLink(std::vector<Place>& places, scene::Link& link) {
  scene::MassProperties& body = link.inertia;
  places.push_back({&body.mass, "mass", link.name, "kg"});
  addVector(places, body.com, "com", link.name, "m");
  const std::pair<const char*, Number*> moments[] = {{"xx", &body.xx}, {"yy", &body.yy},
                                                     {"zz", &body.zz}, {"xy", &body.xy},
                                                     {"xz", &body.xz}, {"yz", &body.yz}};
  for (const auto& [axes, moment] : moments)
    places.push_back({moment, std::string("inertia_") + axes, link.name, "kg m^2"});
}

void addJoint(std::vector<Place>& places, scene::Joint& joint) {
  addVector(places, joint.placement.xyz, "", joint.name, "m");
  places.push_back({&joint.placement.a, "a", joint.name, "m"});
  places.push_back({&joint.placement.d, "d", joint.name, "m"});
  if (scene::degreesOfFreedom(joint.kind) != 1) return;
  const bool slides = scene::slides(joint.kind, 0);
  const char* const force = slides ? "N" : "N m";
  places.push_back({&joint.pitch, "pitch", joint.name, "m/rad"});
  if (!joint.rotor_inertia.isLiteralZero()) {
    places.push_back({&joint.rotor_inertia, "rotor_inertia", joint.name, "kg m^2"});
    places.push_back({&joint.gear_ratio, "gear_ratio", joint.name, slides ? "rad/m" : "1"});
  }
  places.push_back(
      {&joint.friction.viscous, "damping", joint.name, slides ? "N s/m" : "N m s/rad"});
  places.push_back({&joint.friction.positive, "coulomb_positive", joint.name, force});
  places.push_back({&joint.friction.negative, "coulomb_negative", joint.name, force});
  if (joint.stiffness.isLiteralZero()) return;
  places.push_back({&joint.stiffness, "stiffness", joint.name, slides ? "N/m" : "N m/rad"});
  places.push_back({&joint.rest, "rest", joint.name, slides ? "m" : "rad"});
}

/// All numbers that may become fields.
std::vector<Place> placesOf(Mechanism& mechanism) {
  std::vector<Place> places;
  if (mechanism.has_gravity) addVector(places, mechanism.gravity, "gravity", "", "m/s^2");
  for (scene::Link& link : mechanism.links) {
    if (link.parent < 0) continue;  // rests in the world
    addJoint(places, link.joint);
    addLink(places, link);
  }
  for (scene::Wrench& wrench : mechanism.wrenches) {
    const std::string& owner = mechanism.links[wrench.link].name;
    addVector(places, wrench.force, "force", owner, "N");
    addVector(places, wrench.moment, "moment", owner, "N m");
    addVector(places, wrench.at, "force_at", owner, "m");
  }
  return places;
}

/// All that turns frames.
std::vector<Number*> turnsOf(Mechanism& mechanism) {
  std::vector<Number*> turns;
  for (scene::Link& link : mechanism.links) {
    scene::Placement& placement = link.joint.placement;
    for (scene::Vector* v : {&placement.rpy, &link.joint.axis, &link.inertia.rpy})
      for (Number& number : *v) turns.push_back(&number);
    turns.push_back(&placement.alpha);
    turns.push_back(&placement.theta);
  }
  return turns;
}

/// The parameter that a product has as its only factor but numbers, and "" where there is none.
std::string soleFactor(const Number& e) {
  const std::set<std::string> names = e.parameters();
  switch (e.kind()) {
    case Number::Kind::kParameter:
      return e.parameter();
    case Number::Kind::kNegate:
      return soleFactor(e.left());
    case Number::Kind::kMultiply:
      if (names.size() != 1) return "";
      return e.left().parameters().empty()    ? soleFactor(e.right())
             : e.right().parameters().empty() ? soleFactor(e.left())
                                              : "";
    case Number::Kind::kDivide:
      return e.right().parameters().empty() ? soleFactor(e.left()) : "";
    case Number::Kind::kAdd:
    case Number::Kind::kSubtract: {  // terms of a sum have one unit
      const std::string left = soleFactor(e.left());
      return left.empty() ? soleFactor(e.right()) : left;
    }
    default:
      return "";
  }
}

/// Every term's parameters, for units: "l1 + l2" tells both. Where they differ, none is told.
void tellUnits(const Number& e, const std::string& unit,
               std::map<std::string, std::string>& units) {
  if (e.kind() == Number::Kind::kAdd || e.kind() == Number::Kind::kSubtract) {
    tellUnits(e.left(), unit, units);
    tellUnits(e.right(), unit, units);
  } else if (const std::string name = soleFactor(e); !name.empty()) {
    const auto [told, is_new] = units.emplace(name, unit);
    if (!is_new && told->second != unit) told->second = "";
  }
}

/// A word of letters, digits and _ that is none of the four languages' own.
std::string plainWord(const std::string& text, std::set<std::string>& taken) {
  static const std::set<std::string> kOwn = {
      "and",       "as",         "assert",   "async",    "auto",   "await",     "begin",
      "bool",      "break",      "case",     "catch",    "char",   "class",     "const",
      "continue",  "def",        "default",  "del",      "delete", "do",        "double",
      "elif",      "else",       "elseif",   "end",      "enum",   "except",    "export",
      "extern",    "finally",    "float",    "for",      "from",   "function",  "global",
      "goto",      "if",         "import",   "in",       "inline", "int",       "is",
      "lambda",    "let",        "local",    "long",     "macro",  "module",    "mutable",
      "namespace", "new",        "nonlocal", "not",      "or",     "otherwise", "parfor",
      "pass",      "persistent", "private",  "public",   "quote",  "raise",     "register",
      "restrict",  "return",     "short",    "signed",   "sizeof", "spmd",      "static",
      "struct",    "switch",     "template", "this",     "throw",  "true",      "false",
      "try",       "typedef",    "union",    "unsigned", "using",  "virtual",   "void",
      "volatile",  "while",      "with",     "yield"};
  std::string word;
  for (const char ch : text)
    word += ch > 0 && std::isalnum(static_cast<unsigned char>(ch)) != 0 ? ch : '_';
  // MATLAB's names start with a letter
  if (word.empty() || std::isalpha(static_cast<unsigned char>(word[0])) == 0) word = "p" + word;
  if (kOwn.count(word) > 0) word += "_";
  std::string unique = word;
  for (int k = 2; !taken.insert(unique).second; ++k) unique = fmt::format("{}_{}", word, k);
  return unique;
}

bool isZero(const Number& number, const ParameterValues& values) {
  return exactValue(number, values).isZero();
}

}  // namespace

scene::Number ParametrizedMechanism::inFields(const scene::Number& number) const {
  std::map<std::string, Number> meaning;
  for (const scene::Parameter& parameter : as_written.parameters)
    meaning.emplace(parameter.name, parameter.value);
  return substituted(number, meaning);
}

ParametrizedMechanism parametrized(const Mechanism& mechanism) {
  ParametrizedMechanism out{mechanism, {}, {}, mechanism};
  Mechanism& m = out.mechanism;
  const ParameterValues values = mechanism.parameterValues();

  // what each of the scene's parameters means in those that are made of no others
  std::map<std::string, Number> meaning;
  for (const scene::Parameter& parameter : m.parameters)
    meaning.emplace(parameter.name, parameter.value.parameters().empty()
                                        ? Number::parse(parameter.name)
                                        : substituted(parameter.value, meaning));
  std::set<std::string> turning;
  for (const Number* number : turnsOf(m))
    for (const std::string& name : substituted(*number, meaning).parameters()) turning.insert(name);
  std::map<std::string, Number> folded;
  for (const std::string& name : turning) folded.emplace(name, valueOf(values.at(name)));
  for (auto& [name, number] : meaning) number = substituted(number, folded);
  for (Number* number : turnsOf(m)) *number = substituted(*number, meaning);
  out.folded.assign(turning.begin(), turning.end());

  std::set<std::string> taken;
  std::map<std::string, std::string> units;
  std::vector<Place> places = placesOf(m);
  std::set<std::string> used;
  for (Place& place : places) {
    *place.number = substituted(*place.number, meaning);
    const std::set<std::string> names = place.number->parameters();
    used.insert(names.begin(), names.end());
    tellUnits(*place.number, place.unit, units);
  }
  std::vector<scene::Parameter> fields;
  std::map<std::string, Number> renamed;
  for (const scene::Parameter& parameter : m.parameters) {
    if (used.count(parameter.name) == 0) continue;
    const std::string word = plainWord(parameter.name, taken);
    if (word != parameter.name) renamed.emplace(parameter.name, Number::parse(word));
    fields.push_back({word, valueOf(values.at(parameter.name)), parameter.where});
    out.fields.push_back({word, units[parameter.name], parameter.name});
  }
  for (auto& [name, number] : meaning) number = substituted(number, renamed);
  for (Place& place : places) {
    *place.number = substituted(*place.number, renamed);
    if (!place.number->parameters().empty() || isZero(*place.number, {})) continue;
    if (place.word == "gear_ratio" && exactValue(*place.number, {}) == scene::Exact{1, 0}) continue;
    const std::string word = plainWord(place.name(), taken);
    fields.push_back({word, *place.number, {}});
    out.fields.push_back({word, place.unit, place.what()});
    *place.number = Number::parse(word);
  }
  for (scene::Parameter& parameter : out.as_written.parameters)
    parameter.value = meaning.at(parameter.name);
  m.parameters = fields;
  return out;
}

}  // namespace dynwitness::crosscheck::kernel
