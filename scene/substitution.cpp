// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/substitution.hpp"

#include <algorithm>
#include <cctype>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/nearest_name.hpp"

namespace dynwitness::scene {
namespace {

using Replacements =
    std::map<std::string, std::string>;  ///< a name -> an expression in parentheses

bool beginsName(char ch) {
  return std::isalpha(static_cast<unsigned char>(ch)) != 0 || ch == '_';
}
bool isInName(char ch) {
  return beginsName(ch) || std::isdigit(static_cast<unsigned char>(ch)) != 0;
}

/// The text of an expression with names replaced; the e of 1e-3 is none.
std::string replacedText(const std::string& text, const Replacements& replacements) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at + 1;
    if (beginsName(text[at])) {
      while (end < text.size() && isInName(text[end])) ++end;
      const std::string name = text.substr(at, end - at);
      const auto found = replacements.find(name);
      out += found != replacements.end() ? found->second : name;
    } else {
      if (std::isdigit(static_cast<unsigned char>(text[at])) != 0 || text[at] == '.')
        while (end < text.size() && (isInName(text[end]) || text[end] == '.' ||
                                     (std::string("+-").find(text[end]) != std::string::npos &&
                                      std::tolower(text[end - 1]) == 'e')))
          ++end;
      out += text.substr(at, end - at);
    }
    at = end;
  }
  return out;
}

/// Goes through all numbers of a mechanism.
class Putting {
 public:
  Putting(const Replacements& replacements, const ParameterValues& values)
      : replacements_(replacements), values_(values) {}

  void put(Mechanism* m) const {
    numbers(m->gravity);
    for (Link& link : m->links) {
      where_ = link.where;
      put(&link.joint);
      put(&link.inertia);
    }
    where_ = {};
    for (Wrench& w : m->wrenches)
      for (Vector* v : {&w.force, &w.moment, &w.at}) numbers(*v);
    for (Closure& c : m->closures) {
      where_ = c.where;
      put(&c.a), put(&c.b), number(c.length);
    }
    for (Spring& s : m->springs) {
      where_ = s.where;
      put(&s.a), put(&s.b), number(s.stiffness), number(s.rest), number(s.damping);
    }
    for (AccelerationConstraint& a : m->acceleration_constraints) {
      where_ = a.where;
      for (Vector* v : {&a.at, &a.direction, &a.rotation}) numbers(*v);
      number(a.value), number(a.compliance);
    }
  }

 private:
  void number(Number& n) const {
    const std::set<std::string> names = n.parameters();
    if (std::none_of(names.begin(), names.end(),
                     [&](const std::string& name) { return replacements_.count(name) != 0; }))
      return;
    n = Number::parse(replacedText(n.text(), replacements_), where_);
    exactValue(n, values_, where_);  // a division by 0 is told here
    // a number is one, so that what asks for zeros sees them
    if (n.parameters().empty())
      if (const Exact x = exactValue(n, values_, where_); x.isRational()) n = Number(x.rational);
  }
  void numbers(Vector& v) const {
    for (Number& n : v) number(n);
  }
  void put(Attachment* a) const { numbers(a->xyz), numbers(a->rpy); }
  void put(MassProperties* p) const {
    number(p->mass), numbers(p->com), numbers(p->rpy);
    for (Number* n : {&p->xx, &p->yy, &p->zz, &p->xy, &p->xz, &p->yz}) number(*n);
  }
  void put(Joint* j) const {
    numbers(j->placement.xyz), numbers(j->placement.rpy);
    for (Number* n : {&j->placement.a, &j->placement.alpha, &j->placement.d, &j->placement.theta,
                      &j->pitch, &j->rotor_inertia, &j->gear_ratio, &j->stiffness, &j->rest,
                      &j->friction.viscous, &j->friction.positive, &j->friction.negative})
      number(*n);
    axis(j->axis);
    for (Rotor& rotor : j->rotors) {
      number(rotor.inertia);
      for (Number& n : rotor.ratio) number(n);
      if (rotor.axis) axis(*rotor.axis);
    }
    for (Expression& motion : j->motion)
      motion = Expression::parseOfTime(replacedText(motion.text(), replacements_), where_);
    if (j->mimic) number(j->mimic->multiplier), number(j->mimic->offset);
  }
  void axis(Vector& v) const {
    numbers(v);
    if (std::all_of(v.begin(), v.end(),
                    [&](const Number& n) { return exactValue(n, values_, where_).isZero(); }))
      throw InputError(where_, "an axis of length 0 is left of what is substituted");
  }

  const Replacements& replacements_;
  const ParameterValues& values_;
  mutable SourceLocation where_;
};

}  // namespace

Mechanism substituted(const Mechanism& mechanism, const std::vector<std::string>& words) {
  std::vector<std::string> names;
  for (const Parameter& p : mechanism.parameters) names.push_back(p.name);
  Replacements replacements;
  std::map<std::string, Number> values;
  for (const std::string& word : words) {
    const std::size_t sign = word.find('=');
    const std::string name = word.substr(0, sign);
    if (sign == std::string::npos || sign == 0 || sign + 1 == word.size())
      throw InputError({}, fmt::format("--substitute: read '{}', allowed: PARAMETER=VALUE, such as "
                                       "l=1 or m2=0",
                                       word));
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InputError({}, fmt::format("--substitute: no parameter '{}'{}, allowed: {}", name,
                                       didYouMean(name, names),
                                       names.empty() ? "none, this scene has no parameters"
                                                     : fmt::format("{}", fmt::join(names, ", "))));
    const Number value = Number::parse(word.substr(sign + 1), {"--substitute", 0});
    if (!values.emplace(name, value).second)
      throw InputError({}, fmt::format("--substitute: {} is given twice", name));
    replacements[name] = "(" + value.text() + ")";
  }
  ParameterValues exact = mechanism.parameterValues();
  for (const auto& [name, value] : values) {
    for (const std::string& inner : value.parameters())
      if (values.count(inner))
        throw InputError({}, fmt::format("--substitute: {} = {}, and {} is substituted itself, "
                                         "allowed: numbers and the other parameters",
                                         name, value.text(), inner));
    exactValue(value, exact, {"--substitute", 0});
  }
  Mechanism out = mechanism;
  for (Parameter& p : out.parameters) {  // by number: what they were made of may be gone
    const Exact& x = exact.at(p.name);
    p.value =
        x.isRational()
            ? Number(x.rational)
            : Number::parse(fmt::format("({}) + ({})*pi", x.rational.str(), x.pi_multiple.str()));
  }
  out.parameters.erase(
      std::remove_if(out.parameters.begin(), out.parameters.end(),
                     [&](const Parameter& p) { return values.count(p.name) != 0; }),
      out.parameters.end());
  const ParameterValues left = out.parameterValues();
  Putting(replacements, left).put(&out);
  return out;
}

}  // namespace dynwitness::scene
