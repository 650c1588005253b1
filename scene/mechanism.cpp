// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/mechanism.hpp"

#include <algorithm>
#include <stdexcept>

#include "scene/mimic.hpp"

namespace dynwitness::scene {
namespace {

void translate(const Number& x, const Number& y, const Number& z, std::vector<Step>* steps) {
  if (x.isLiteralZero() && y.isLiteralZero() && z.isLiteralZero()) return;
  steps->push_back({Step::Kind::kTranslate, {x, y, z}, Number()});
}

void rotate(Step::Kind kind, const Number& angle, std::vector<Step>* steps) {
  if (angle.isLiteralZero()) return;
  steps->push_back({kind, {}, angle});
}

}  // namespace

Link::Link() = default;
Link::Link(const Link&) = default;
Link::Link(Link&&) noexcept = default;
Link& Link::operator=(const Link&) = default;
Link& Link::operator=(Link&&) noexcept = default;
Link::~Link() = default;

Mechanism::Mechanism() = default;
Mechanism::Mechanism(const Mechanism&) = default;
Mechanism::Mechanism(Mechanism&&) noexcept = default;
Mechanism& Mechanism::operator=(const Mechanism&) = default;
Mechanism& Mechanism::operator=(Mechanism&&) noexcept = default;
Mechanism::~Mechanism() = default;

int degreesOfFreedom(JointKind kind) {
  return static_cast<int>(rateNames(kind).size());
}

const char* name(JointKind kind) {
  switch (kind) {
    case JointKind::kFixed:
      return "fixed";
    case JointKind::kRevolute:
      return "revolute";
    case JointKind::kPrismatic:
      return "prismatic";
    case JointKind::kHelical:
      return "helical";
    case JointKind::kCylindrical:
      return "cylindrical";
    case JointKind::kUniversal:
      return "universal";
    case JointKind::kPlanar:
      return "planar";
    case JointKind::kSpherical:
      return "spherical";
    case JointKind::kFloating:
      return "floating";
  }
  throw std::logic_error("name: unknown joint kind");
}

const char* name(ClosureKind kind) {
  switch (kind) {
    case ClosureKind::kDistance:
      return "distance";
    case ClosureKind::kPlane:
      return "plane";
    case ClosureKind::kPlanarPoint:
      return "planar_point";
    case ClosureKind::kPoint:
      return "point";
    case ClosureKind::kHinge:
      return "hinge";
    case ClosureKind::kWeld:
      return "weld";
    case ClosureKind::kSkate:
      return "skate";
    case ClosureKind::kRolling:
      return "rolling";
  }
  throw std::logic_error("name: unknown closure kind");
}

int equationCount(ClosureKind kind) {
  switch (kind) {
    case ClosureKind::kDistance:
    case ClosureKind::kPlane:
    case ClosureKind::kSkate:
      return 1;
    case ClosureKind::kPlanarPoint:
      return 2;
    case ClosureKind::kPoint:
    case ClosureKind::kRolling:
      return 3;
    case ClosureKind::kHinge:
      return 5;
    case ClosureKind::kWeld:
      return 6;
  }
  throw std::logic_error("equationCount: unknown closure kind");
}

bool isOfRates(ClosureKind kind, int row) {
  return kind == ClosureKind::kSkate || (kind == ClosureKind::kRolling && row < 2);
}

std::vector<Step> Attachment::steps() const {
  Placement placement;
  placement.xyz = xyz;
  placement.rpy = rpy;
  return placement.beforeJoint();
}

namespace {

/// What there is to know about a joint kind.
struct KindInfo {
  std::vector<SlotKind> slots;
  std::vector<std::string> rates;
};

const KindInfo& info(JointKind kind) {
  constexpr SlotKind a = SlotKind::kAngle, d = SlotKind::kLength, h = SlotKind::kQuaternion;
  static const KindInfo kInfos[] = {
      {{}, {}},                                                        // fixed
      {{a}, {""}},                                                     // revolute
      {{d}, {""}},                                                     // prismatic
      {{a}, {""}},                                                     // helical
      {{d, a}, {"slide", "turn"}},                                     // cylindrical
      {{a, a}, {"turn_x", "turn_y"}},                                  // universal
      {{d, d, a}, {"x", "y", "turn"}},                                 // planar
      {{h, h, h, h}, {"wx", "wy", "wz"}},                              // spherical
      {{d, d, d, h, h, h, h}, {"vx", "vy", "vz", "wx", "wy", "wz"}}};  // floating
  return kInfos[static_cast<int>(kind)];
}

}  // namespace

const std::vector<SlotKind>& positionSlots(JointKind kind) {
  return info(kind).slots;
}
const std::vector<std::string>& rateNames(JointKind kind) {
  return info(kind).rates;
}
bool ratesArePositionDerivatives(JointKind kind) {
  return info(kind).slots.size() == info(kind).rates.size();
}

bool hasAxis(JointKind kind) {
  switch (kind) {
    case JointKind::kRevolute:
    case JointKind::kPrismatic:
    case JointKind::kHelical:
    case JointKind::kCylindrical:
    case JointKind::kPlanar:
      return true;
    default:
      return false;
  }
}

std::vector<Step> Placement::beforeJoint() const {
  std::vector<Step> steps;
  switch (convention) {
    case Convention::kXyzRpy:
      translate(xyz[0], xyz[1], xyz[2], &steps);
      rotate(Step::Kind::kRotateZ, rpy[2], &steps);
      rotate(Step::Kind::kRotateY, rpy[1], &steps);
      rotate(Step::Kind::kRotateX, rpy[0], &steps);
      break;
    case Convention::kDh:
      break;
    case Convention::kMdh:
      rotate(Step::Kind::kRotateX, alpha, &steps);
      translate(a, 0, 0, &steps);
      rotate(Step::Kind::kRotateZ, theta, &steps);
      translate(0, 0, d, &steps);
      break;
  }
  return steps;
}

std::vector<Step> Placement::afterJoint() const {
  std::vector<Step> steps;
  if (convention == Convention::kDh) {
    rotate(Step::Kind::kRotateZ, theta, &steps);
    translate(a, 0, d, &steps);  // Tz(d) Tx(a): no turn between them
    rotate(Step::Kind::kRotateX, alpha, &steps);
  }
  return steps;
}

std::vector<const Expression*> Mechanism::motions() const {
  std::vector<const Expression*> all;
  for (const Link& link : links) {
    const int n = link.joint.ownRates();
    for (int k = 0; k < n; ++k)
      all.push_back(link.joint.motion.empty() ? nullptr
                                              : &link.joint.motion[static_cast<std::size_t>(k)]);
  }
  return all;
}

bool Mechanism::isDriven() const {
  return std::any_of(links.begin(), links.end(),
                     [](const Link& link) { return !link.joint.motion.empty(); });
}

int Mechanism::dof() const {
  int n = 0;
  for (const Link& link : links) n += link.joint.ownRates();
  return n;
}

int Mechanism::positions() const {
  std::size_t n = 0;
  for (const Link& link : links) n += positionSlots(link.joint.kind).size();
  return static_cast<int>(n);
}

std::vector<SlotKind> Mechanism::slots() const {
  std::vector<SlotKind> all;
  for (const Link& link : links)
    for (const SlotKind slot : positionSlots(link.joint.kind)) all.push_back(slot);
  return all;
}

std::vector<std::string> Mechanism::rateLabels() const {
  std::vector<std::string> labels;
  for (const Link& link : links) {
    if (link.joint.mimic) continue;
    for (const std::string& rate : rateNames(link.joint.kind))
      labels.push_back(link.joint.name + (rate.empty() ? "" : "." + rate));
  }
  return labels;
}

std::vector<Number> Mechanism::restPosition() const {
  std::vector<Number> q;
  const Number zero(0), one(1);  // shared
  for (const Link& link : links) {
    const std::vector<SlotKind>& slots = positionSlots(link.joint.kind);
    for (std::size_t k = 0; k < slots.size(); ++k) {
      const bool is_w = slots[k] == SlotKind::kQuaternion && k + 4 == slots.size();
      q.push_back(is_w ? one : zero);
    }
  }
  followLeaders(followers(*this), &q);
  return q;
}

bool Mechanism::hasClosuresOfRates() const {
  return std::any_of(closures.begin(), closures.end(),
                     [](const Closure& closure) { return isOfRates(closure.kind, 0); });
}

bool Mechanism::hasMimics() const {
  return std::any_of(links.begin(), links.end(),
                     [](const Link& link) { return link.joint.mimic.has_value(); });
}

bool Mechanism::hasGearedRotors() const {
  return std::any_of(links.begin(), links.end(),
                     [](const Link& link) { return !link.joint.rotors.empty(); });
}

bool Mechanism::hasFriction() const {
  return std::any_of(links.begin(), links.end(),
                     [](const Link& link) { return !link.joint.friction.isNone(); });
}
bool Mechanism::hasCoulombFriction() const {
  return std::any_of(links.begin(), links.end(),
                     [](const Link& link) { return link.joint.friction.isCoulomb(); });
}
bool Mechanism::hasGyroscopicRotors() const {
  return std::any_of(links.begin(), links.end(), [](const Link& link) {
    const std::vector<Rotor>& rotors = link.joint.rotors;
    return link.joint.gyroscopic ||
           std::any_of(rotors.begin(), rotors.end(),
                       [](const Rotor& rotor) { return rotor.axis.has_value(); });
  });
}

std::vector<int> Mechanism::movingLinks() const {
  std::vector<int> moving;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (degreesOfFreedom(links[i].joint.kind) > 0) moving.push_back(static_cast<int>(i));
  }
  return moving;
}

ParameterValues Mechanism::parameterValues() const {
  ParameterValues values;
  for (const Parameter& p : parameters) values[p.name] = exactValue(p.value, values, p.where);
  return values;
}

}  // namespace dynwitness::scene
