// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/uncertainty.hpp"

#include <algorithm>
#include <map>
#include <string>

#include <fmt/format.h>

namespace dynwitness::crosscheck {
namespace {

using scene::Expression;
using scene::Mechanism;
using scene::UncertainParameter;
using Kind = Expression::Kind;

constexpr int kNoPolynomial = 1000;  ///< of a quotient by it

/// Degrees of expressions in one parameter, through the parameters that are given by it.
class Degree {
 public:
  Degree(const Mechanism& mechanism, const std::vector<UncertainParameter>& uncertain,
         const std::string& of) {
    for (const scene::Parameter& p : mechanism.parameters) {
      // one that is uncertain itself has its own range, whatever it was written as
      const bool is_own =
          std::any_of(uncertain.begin(), uncertain.end(),
                      [&](const UncertainParameter& u) { return u.name == p.name; });
      known_[p.name] = p.name == of ? 1 : is_own ? 0 : (*this)(p.value);
    }
  }

  int operator()(const Expression& e) const {
    switch (e.kind()) {
      case Kind::kParameter:
        return known_.at(e.parameter());
      case Kind::kNegate:
        return (*this)(e.left());
      case Kind::kAdd:
      case Kind::kSubtract:
        return std::max((*this)(e.left()), (*this)(e.right()));
      case Kind::kMultiply:
        return std::min(kNoPolynomial, (*this)(e.left()) + (*this)(e.right()));
      case Kind::kDivide:
        return (*this)(e.right()) == 0 ? (*this)(e.left()) : kNoPolynomial;
      case Kind::kPower:
        return (*this)(e.left()) == 0 || e.exponent() == 0 ? 0
               : e.exponent() < 0                          ? kNoPolynomial
                                  : std::min(kNoPolynomial, e.exponent() * (*this)(e.left()));
      default:
        return 0;
    }
  }

 private:
  std::map<std::string, int> known_;
};

/// All numbers that the quantities of an envelope depend on, each with what it is, and whether they
/// are linear in it.
template <typename Visit>
void visitNumbers(const Mechanism& mechanism, const Visit& visit) {
  const auto vector = [&](const scene::Vector& v, const std::string& what) {
    for (const scene::Number& n : v) visit(n, what, false);
  };
  vector(mechanism.gravity, "gravity");
  for (const scene::Link& link : mechanism.links) {
    const scene::Joint& j = link.joint;
    const scene::MassProperties& m = link.inertia;
    visit(m.mass, "mass of " + link.name, true);
    for (const scene::Number* n : {&m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz})
      visit(*n, "inertia of " + link.name, true);
    for (const scene::Number* n : {&j.rotor_inertia, &j.stiffness, &j.friction.viscous,
                                   &j.friction.positive, &j.friction.negative})
      visit(*n, "rotor inertia, stiffness or friction of " + j.name, true);
    vector(m.com, "com of " + link.name);
    vector(m.rpy, "axes of the inertia of " + link.name);
    const std::string place = "placement of " + j.name;
    vector(j.placement.xyz, place);
    vector(j.placement.rpy, place);
    vector(j.axis, "axis of " + j.name);
    for (const scene::Number* n :
         {&j.placement.a, &j.placement.alpha, &j.placement.d, &j.placement.theta, &j.pitch})
      visit(*n, place, false);
    visit(j.gear_ratio, "gear ratio of " + j.name, false);
    visit(j.rest, "rest of the spring of " + j.name, false);
    for (const scene::Rotor& rotor : j.rotors) visit(rotor.inertia, "rotors of " + j.name, false);
  }
  for (const scene::Wrench& w : mechanism.wrenches)
    for (const scene::Vector* v : {&w.force, &w.moment, &w.at}) vector(*v, "a wrench");
}

}  // namespace

void requireLinear(const scene::Scene& scene, const std::vector<UncertainParameter>& parameters) {
  for (const UncertainParameter& p : parameters) {
    const Degree degree(scene.mechanism, parameters, p.name);
    visitNumbers(
        scene.mechanism, [&](const scene::Number& n, const std::string& what, bool is_linear) {
          if (degree(n) <= (is_linear ? 1 : 0)) return;
          throw scene::InputError(
              {scene.file.string()},
              fmt::format("envelope.parameters: {}: the {} is \"{}\", in which forces are not "
                          "linear in it, allowed: parameters of degree 1 in masses, "
                          "inertias, rotor inertias, stiffness and friction",
                          p.name, what, n.text()));
        });
  }
}

scene::Scene atCorner(const scene::Scene& scene, const std::vector<UncertainParameter>& parameters,
                      const std::vector<bool>& upper) {
  scene::Scene out = scene;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    for (scene::Parameter& p : out.mechanism.parameters)
      if (p.name == parameters[k].name)
        p.value = Expression(upper[k] ? parameters[k].high : parameters[k].low);
  return out;
}

}  // namespace dynwitness::crosscheck
