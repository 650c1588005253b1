// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/own_rates.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "scene/mimic.hpp"

namespace dynwitness::scene {
namespace {

/// Of an axis along one of the frame's: which. -1: none.
int alongCoordinate(const Vector& axis) {
  int found = -1;
  for (int k = 0; k < 3; ++k) {
    if (axis[static_cast<std::size_t>(k)].isLiteralZero()) continue;
    if (found >= 0) return -1;
    found = k;
  }
  return found;
}

/// By link: whether it rests in the world.
std::vector<bool> resting(const Mechanism& mechanism) {
  std::vector<bool> rests;
  for (const Link& link : mechanism.links)
    rests.push_back(link.parent < 0 || (rests[static_cast<std::size_t>(link.parent)] &&
                                        link.joint.kind == JointKind::kFixed));
  return rests;
}

Link spinning(const std::string& name, int parent, const Number& inertia) {
  Link link;
  link.name = name;
  link.parent = parent;
  link.joint.name = name;
  link.joint.kind = JointKind::kRevolute;
  link.inertia.zz = inertia;
  return link;
}

void addInWorld(const std::string& name, const Rotor& rotor, Mechanism* tree) {
  Link link = spinning(name, 0, rotor.inertia);
  link.inertia.mass = Number(1);
  link.inertia.xx = link.inertia.yy = Number::parse("(" + rotor.inertia.text() + ")/2");
  tree->links.push_back(link);
}

void addOnLink(const std::string& name, const Link& driven, const Rotor& rotor, Mechanism* tree) {
  Link link = spinning(name, driven.parent, 0);
  // the joint frame: of a Denavit-Hartenberg row the parent's
  if (driven.joint.placement.convention != Placement::Convention::kDh)
    link.joint.placement = driven.joint.placement;
  const int k = alongCoordinate(*rotor.axis);
  Number MassProperties::*const moments[] = {&MassProperties::xx, &MassProperties::yy,
                                             &MassProperties::zz};
  Link lacking = link;
  lacking.name = lacking.joint.name = name + ".lacking";
  lacking.joint.kind = JointKind::kFixed;
  lacking.inertia.*moments[k] = Number::parse("-(" + rotor.inertia.text() + ")");
  link.joint.axis = *rotor.axis;
  link.inertia.*moments[k] = rotor.inertia;
  tree->links.push_back(link);
  tree->links.push_back(lacking);
}

/// Geared to several rates, with an axis of their own on the parent.
bool hasGyroscopicRotors(const Link& link) {
  const auto& rotors = link.joint.rotors;
  return std::any_of(rotors.begin(), rotors.end(),
                     [](const Rotor& rotor) { return rotor.axis.has_value(); });
}

}  // namespace

Mechanism withOwnRates(const Mechanism& mechanism) {
  if (const std::string reason = hasNoTree(mechanism); !reason.empty())
    throw InputError({}, reason);
  Mechanism tree = withoutMimics(mechanism);
  const std::vector<bool> rests = resting(mechanism);
  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const Link& link = mechanism.links[i];
    tree.links[i].joint.rotors.clear();
    for (std::size_t k = 0; k < link.joint.rotors.size(); ++k) {
      const Rotor& rotor = link.joint.rotors[k];
      const std::string name = fmt::format("{}.rotor_{}", link.joint.name, k + 1);
      if (rotor.axis && !rests[static_cast<std::size_t>(link.parent)])
        addOnLink(name, link, rotor, &tree);
      else
        addInWorld(name, rotor, &tree);
    }
  }
  return tree;
}

bool hasLackingLinks(const Mechanism& mechanism) {
  const std::vector<bool> rests = resting(mechanism);
  return std::any_of(mechanism.links.begin(), mechanism.links.end(), [&](const Link& link) {
    return hasGyroscopicRotors(link) && !rests[static_cast<std::size_t>(link.parent)];
  });
}

bool hasRotorsHeldAtRest(const Mechanism& mechanism) {
  const std::vector<bool> rests = resting(mechanism);
  return std::any_of(mechanism.links.begin(), mechanism.links.end(), [&](const Link& link) {
    return hasGyroscopicRotors(link) && link.parent > 0 &&
           rests[static_cast<std::size_t>(link.parent)];
  });
}

std::string hasNoTree(const Mechanism& mechanism) {
  const std::vector<bool> rests = resting(mechanism);
  for (const Link& link : mechanism.links)
    for (const Rotor& rotor : link.joint.rotors)
      if (rotor.axis && !rests[static_cast<std::size_t>(link.parent)] &&
          alongCoordinate(*rotor.axis) < 0)
        return "joint \"" + link.joint.name +
               "\": a gyroscopic rotor's axis is none of the joint frame's, so that as a link its "
               "inertia has no exact numbers";
  return "";
}

}  // namespace dynwitness::scene
