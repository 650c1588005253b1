// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/reduction/omissions.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "scene/written_numbers.hpp"

namespace dynwitness::crosscheck {
namespace {

bool hasInertia(const scene::MassProperties& m) {
  for (const scene::Number* x : {&m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz})
    if (!x->isLiteralZero()) return true;
  return false;
}

void clearInertia(scene::MassProperties* m) {
  for (scene::Number* x : {&m->xx, &m->yy, &m->zz, &m->xy, &m->xz, &m->yz}) *x = 0;
  m->about = scene::MassProperties::About::kCenterOfMass;
  m->rpy = {};
}

/// Which coordinate axis of the link's own frame the joint turns about, through its origin; -1:
/// none.
int ownAxis(const scene::Joint& joint) {
  if (joint.kind != scene::JointKind::kRevolute ||
      joint.placement.convention == scene::Placement::Convention::kDh)
    return -1;
  int axis = -1;
  for (int k = 0; k < 3; ++k) {
    if (joint.axis[static_cast<std::size_t>(k)].isLiteralZero()) continue;
    if (axis >= 0) return -1;
    axis = k;
  }
  return axis;
}

/// From the link's origin, which leaves products that a diagonal inertia at the centre has not.
void takeAboutCenterOfMass(const scene::Mechanism& mechanism, scene::MassProperties* m) {
  if (m->about != scene::MassProperties::About::kLinkOrigin) return;
  const scene::written::Inertial central =
      scene::written::aboutCenterOfMass(*m, scene::written::Numbers(mechanism));
  const auto number = [&](int i, int k) {
    return scene::Expression::parse(scene::written::text(central.I(i, k)));
  };
  m->about = scene::MassProperties::About::kCenterOfMass;
  if (central.origin.rpy.isZero(0)) m->rpy = {};
  m->xx = number(0, 0), m->yy = number(1, 1), m->zz = number(2, 2);
  m->xy = number(0, 1), m->xz = number(0, 2), m->yz = number(1, 2);
}

/// Those that are not gyroscopic.
bool takeRotors(scene::Joint* joint) {
  std::vector<scene::Rotor>& geared = joint->rotors;
  const auto kept = std::remove_if(geared.begin(), geared.end(),
                                   [](const scene::Rotor& rotor) { return !rotor.axis; });
  bool any = kept != geared.end();
  geared.erase(kept, geared.end());
  if (!joint->gyroscopic && !joint->rotor_inertia.isLiteralZero()) {
    joint->rotor_inertia = 0;
    any = true;
  }
  return any;
}

/// They go on turning, and nobody but their joint feels it.
bool takeSpins(scene::Joint* joint) {
  bool any = std::exchange(joint->gyroscopic, false);
  for (scene::Rotor& rotor : joint->rotors) any = std::exchange(rotor.axis, std::nullopt) || any;
  return any;
}

}  // namespace

bool apply(const Omission& omission, scene::Mechanism* mechanism) {
  scene::Link& link = mechanism->links[omission.link];
  scene::MassProperties& m = link.inertia;
  const auto clear = [](scene::Number* x) {
    const bool was = !x->isLiteralZero();
    *x = 0;
    return was;
  };
  switch (omission.what) {
    case Omission::What::kCom:
      return clear(&m.com[static_cast<std::size_t>(omission.axis)]);
    case Omission::What::kProducts: {
      takeAboutCenterOfMass(*mechanism, &m);
      bool any = false;
      for (scene::Number* x : {&m.xy, &m.xz, &m.yz}) any = clear(x) || any;
      return any;
    }
    case Omission::What::kInertia: {
      const bool was = hasInertia(m);
      clearInertia(&m);
      return was;
    }
    case Omission::What::kOnAxis: {
      const int axis = ownAxis(link.joint);
      if (axis < 0 || m.mass.isLiteralZero()) return false;
      bool any = hasInertia(m);
      clearInertia(&m);
      for (int k = 0; k < 3; ++k)
        if (k != axis) any = clear(&m.com[static_cast<std::size_t>(k)]) || any;
      return any;
    }
    case Omission::What::kMass: {
      const bool was = !m.mass.isLiteralZero();
      m = {};
      return was;
    }
    case Omission::What::kRotor:
      return takeRotors(&link.joint);
    case Omission::What::kSpin:
      return takeSpins(&link.joint);
    case Omission::What::kFriction: {
      const bool was = !link.joint.friction.isNone();
      link.joint.friction = {};
      return was;
    }
  }
  return false;
}

std::string words(const Omission& omission, const scene::Mechanism& mechanism) {
  const scene::Link& link = mechanism.links[omission.link];
  switch (omission.what) {
    case Omission::What::kCom:
      return fmt::format("{}: its centre of mass off the origin along {}", link.name,
                         "xyz"[omission.axis]);
    case Omission::What::kProducts:
      return link.name + ": its products of inertia";
    case Omission::What::kInertia:
      return link.name + ": its inertia about the centre of mass";
    case Omission::What::kOnAxis:
      return link.name + ": all but a mass on its joint's axis";
    case Omission::What::kMass:
      return link.name + ": its mass and inertia";
    case Omission::What::kRotor:
      return "joint " + link.joint.name + ": its rotor";
    case Omission::What::kSpin:
      return "joint " + link.joint.name + ": the spin of its rotor, which its carrier feels";
    case Omission::What::kFriction:
      return "joint " + link.joint.name + ": its friction";
  }
  return "";
}

}  // namespace dynwitness::crosscheck
