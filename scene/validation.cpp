// SPDX-License-Identifier: GPL-3.0-or-later
// The one place that says what is physically possible.
//
// Decisions are made in rational arithmetic, so that a mechanism on the border (a thin rod: one
// principal moment is zero, the other two are equal) is on the right side of it. Where a number has
// pi in it, or an angle is not a multiple of pi/2, sines and the like are rationals with an error
// below 1e-60, and the border gets a slack of 1e-40. Where a function is rounded
// (function_values.hpp) a number is within 1e-50 of itself of what is written, or refused: the same
// slack holds that, too.
#include <algorithm>
#include <initializer_list>

#include <fmt/format.h>

#include "scene/arrange.hpp"
#include "scene/faults.hpp"
#include "scene/impossible_inertia.hpp"
#include "scene/inertia_need.hpp"
#include "scene/motion.hpp"
#include "scene/scene.hpp"
#include "scene/validator.hpp"

namespace dynwitness::scene {
namespace validation {

void Validator::run(InertiaNeed need) {
  requireTree();
  requireUniqueNames(mechanism_.links);
  findParameters();
  requireValues();
  Faults faults;
  for (const Link& link : mechanism_.links)
    if (link.parent >= 0) faults.collect([&] { requireJoint(link); });
  if (faults.isEmpty())
    requireBodies();
  else
    faults.collect([&] { requireBodies(); });
  faults.raise();
  requireCarriers();
  requireStart();
  if (need == InertiaNeed::kOfEachJoint) requireInertiaOutboard("");
  for (const Closure& closure : mechanism_.closures) {
    const std::string what = "closure \"" + closure.name + '"';
    requireEnds(what, closure.a.link, closure.b.link, closure.where);
    const double length = exactValue(closure.length, values_, closure.where).toDouble();
    const bool is_disc = closure.kind == ClosureKind::kRolling;
    if ((is_disc || closure.kind == ClosureKind::kDistance) && !(length > 0)) {
      throw InputError(closure.where, what + fmt::format(": {} is {}, allowed: above zero",
                                                         is_disc ? "radius" : "length", length));
    }
  }
  for (const Spring& spring : mechanism_.springs) requireSpring(spring);
}

void Validator::requireInertiaFor(const std::string& asked) {
  findParameters();
  requireBodies();
  requireInertiaOutboard(asked);
}

void Validator::findParameters() {
  values_ = mechanism_.parameterValues();
  for (const Parameter& p : mechanism_.parameters) {
    const Rational error = errorOfFunctions(p.value, values_, parameter_errors_, p.where);
    if (!error.is_zero()) parameter_errors_[p.name] = error;
  }
}

void Validator::requireTree() {
  const std::vector<Link>& links = mechanism_.links;
  if (links.empty()) throw InputError(file_, "no root: there is no link at all");
  for (std::size_t i = 0; i < links.size(); ++i) {
    const int parent = links[i].parent;
    const bool in_order = i == 0 ? parent == -1 : parent >= 0 && parent < static_cast<int>(i);
    if (!in_order) {
      failLink(links[i], fmt::format("index {} with parent {}, allowed: parents before children, "
                                     "and the root at 0 with parent -1",
                                     i, parent));
    }
    if (i > 0 && links[i].joint.name.empty()) failLink(links[i], "its joint has no name");
    const bool moves = i > 0 && degreesOfFreedom(links[i].joint.kind) > 0;
    carriers_.push_back(i == 0  ? 0
                        : moves ? static_cast<int>(i)
                                : carriers_[static_cast<std::size_t>(parent)]);
  }
  const auto dof = static_cast<std::size_t>(mechanism_.dof());
  const auto positions = static_cast<std::size_t>(mechanism_.positions());
  if (scene_.start_q.size() != positions || scene_.start_qd.size() != dof) {
    throw InputError(file_,
                     fmt::format("start: {} positions and {} speeds, allowed: {} and {}",
                                 scene_.start_q.size(), scene_.start_qd.size(), positions, dof));
  }
  for (const Wrench& wrench : mechanism_.wrenches) {
    if (wrench.link >= 0 && wrench.link < static_cast<int>(links.size())) continue;
    throw InputError(file_, fmt::format("wrench: there is no link of index {}", wrench.link));
  }
}

/// Every number has a finite value. (The readers have said so with a better line number.)
void Validator::requireValues() const {
  const auto require = [this](const auto& numbers, const SourceLocation& where) {
    for (const Number& n : numbers) {
      exactValue(n, values_, where);
      errorOfFunctions(n, values_, parameter_errors_, where);
    }
  };
  require(mechanism_.gravity, file_);
  require(scene_.start_q, file_);
  require(scene_.start_qd, file_);
  for (const Wrench& w : mechanism_.wrenches) {
    for (const Vector& v : {w.force, w.moment, w.at}) require(v, file_);
  }
  for (const Link& link : mechanism_.links) {
    if (link.joint.mimic) exactValue(link.joint.mimic->offset, values_, link.where);
  }
  for (const Closure& c : mechanism_.closures) {
    for (const Vector& v : {c.a.xyz, c.a.rpy, c.b.xyz, c.b.rpy}) require(v, c.where);
  }
  for (const Spring& s : mechanism_.springs) {
    for (const Vector& v : {s.a.xyz, s.b.xyz}) require(v, s.where);
    require(std::initializer_list<Number>{s.stiffness, s.rest, s.damping}, s.where);
  }
  for (const Link& link : mechanism_.links) {
    const MassProperties& i = link.inertia;
    const Placement& p = link.joint.placement;
    const Joint& j = link.joint;
    for (const Vector& v : {i.com, i.rpy, p.xyz, p.rpy, j.axis}) require(v, link.where);
    require(std::initializer_list<Number>{i.mass, i.xx, i.yy, i.zz, i.xy, i.xz, i.yz, p.a, p.alpha,
                                          p.d, p.theta, j.pitch, j.rotor_inertia, j.gear_ratio,
                                          j.stiffness, j.rest, j.friction.viscous,
                                          j.friction.positive, j.friction.negative},
            link.where);
    for (const Rotor& rotor : j.rotors) {
      require(std::initializer_list<Number>{rotor.inertia}, link.where);
      require(rotor.ratio, link.where);
      if (rotor.axis) require(*rotor.axis, link.where);
    }
  }
}

/// A quaternion of four zeros says nothing about an orientation.
void Validator::requireStart() const {
  std::size_t end = 0;
  for (const Link& link : mechanism_.links) {
    const std::vector<SlotKind>& slots = positionSlots(link.joint.kind);
    end += slots.size();
    if (slots.empty() || slots.back() != SlotKind::kQuaternion) continue;
    const auto first = scene_.start_q.begin() + static_cast<std::ptrdiff_t>(end) - 4;
    if (std::all_of(first, first + 4,
                    [this](const Number& n) { return exactValue(n, values_).isZero(); }))
      failJoint(link, "its quaternion at the start is [0, 0, 0, 0], allowed: any other");
  }
}

/// What joins two links must be able to do something: they exist, and a joint between them moves.
void Validator::requireEnds(const std::string& what, int a, int b,
                            const SourceLocation& where) const {
  const std::vector<Link>& links = mechanism_.links;
  for (const int link : {a, b}) {
    if (link >= 0 && link < static_cast<int>(links.size())) continue;
    throw InputError(where, what + fmt::format(": there is no link of index {}", link));
  }
  if (carriers_[static_cast<std::size_t>(a)] != carriers_[static_cast<std::size_t>(b)]) return;
  const auto name = [&links](int link) { return links[static_cast<std::size_t>(link)].name; };
  throw InputError(where, what + ": no joint moves between links \"" + name(a) + "\" and \"" +
                              name(b) + "\", allowed: two links that move on each other");
}

void Validator::requireSpring(const Spring& spring) const {
  const std::string what = "spring \"" + spring.name + '"';
  requireEnds(what, spring.a.link, spring.b.link, spring.where);
  const std::pair<const char*, const Number*> numbers[] = {
      {"stiffness", &spring.stiffness}, {"rest", &spring.rest}, {"damping", &spring.damping}};
  for (const auto& [key, n] : numbers) {
    const double value = exactValue(*n, values_, spring.where).toDouble();
    if (value < 0) {
      throw InputError(spring.where,
                       what + fmt::format(": {} is {}, allowed: zero or more", key, value));
    }
  }
}

}  // namespace validation

std::vector<std::string> impossibleInertias(const Scene& scene) {
  return validation::Validator(scene).impossibleInertias();
}

void validate(const Scene& scene) {
  validate(scene, InertiaNeed::kOfEachJoint);
}

void validate(const Scene& scene, InertiaNeed need) {
  validation::Validator(scene).run(need);
  validateMotions(scene);
}

void requireInertiaOfJoints(const Scene& scene, const std::string& asked) {
  validation::Validator(scene).requireInertiaFor(asked);
}

}  // namespace dynwitness::scene
