// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/campaign/smaller.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <vector>

#include "scene/error.hpp"
#include "scene/mechanism.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::JointKind;
using scene::Link;
using scene::Mechanism;
using scene::Number;
using scene::Scene;

/// What may be done to a mechanism. It says whether that changed anything.
using Change = std::function<bool(Mechanism&)>;

template <typename T>
void eraseAt(std::vector<T>& all, std::size_t k) {
  all.erase(all.begin() + static_cast<std::ptrdiff_t>(k));
}

template <typename T, typename Of>
void eraseIf(std::vector<T>& all, const Of& goes) {
  all.erase(std::remove_if(all.begin(), all.end(), goes), all.end());
}

bool setTo(Number& x, int value) {
  const Number wanted(value);
  if (x.text() == wanted.text()) return false;
  x = wanted;
  return true;
}
bool setTo(scene::Vector& v, int x, int y, int z) {
  const bool changed[] = {setTo(v[0], x), setTo(v[1], y), setTo(v[2], z)};
  return changed[0] || changed[1] || changed[2];
}

/// Nobody stands on it any more.
bool isTip(const Mechanism& m, int link) {
  return std::none_of(m.links.begin(), m.links.end(),
                      [&](const Link& other) { return other.parent == link; });
}

/// Takes what hangs on a link that goes, and counts the others anew.
void cutTip(Mechanism& m, int link) {
  const std::string joint = m.links[static_cast<std::size_t>(link)].joint.name;
  for (Link& other : m.links)
    if (other.joint.mimic && other.joint.mimic->joint == joint) other.joint.mimic.reset();
  eraseIf(m.wrenches, [&](const auto& w) { return w.link == link; });
  eraseIf(m.closures, [&](const auto& c) { return c.a.link == link || c.b.link == link; });
  eraseIf(m.springs, [&](const auto& s) { return s.a.link == link || s.b.link == link; });
  eraseIf(m.acceleration_constraints, [&](const auto& c) { return c.link == link; });
  eraseAt(m.links, static_cast<std::size_t>(link));
  const auto counted = [&](int& k) { k -= k > link ? 1 : 0; };
  for (Link& other : m.links) counted(other.parent);
  for (auto& w : m.wrenches) counted(w.link);
  for (auto& c : m.closures) counted(c.a.link), counted(c.b.link);
  for (auto& s : m.springs) counted(s.a.link), counted(s.b.link);
  for (auto& c : m.acceleration_constraints) counted(c.link);
}

/// Without what goes with other kinds.
void makeKind(Mechanism& m, Link& link, JointKind kind) {
  scene::Joint plain;
  plain.name = link.joint.name;
  plain.kind = kind;
  plain.placement = link.joint.placement;
  if (scene::hasAxis(kind) && scene::hasAxis(link.joint.kind)) plain.axis = link.joint.axis;
  for (Link& other : m.links)
    if (other.joint.mimic && other.joint.mimic->joint == plain.name) other.joint.mimic.reset();
  link.joint = plain;
}

/// Whole parts, the largest first.
std::vector<Change> partsOf(const Mechanism& m) {
  std::vector<Change> out;
  const auto each = [&](auto Mechanism::*all) {
    for (std::size_t k = (m.*all).size(); k-- > 0;)
      out.push_back([all, k](Mechanism& of) {
        if (k >= (of.*all).size()) return false;
        eraseAt(of.*all, k);
        return true;
      });
  };
  for (int i = static_cast<int>(m.links.size()) - 1; i > 0; --i)
    out.push_back([i](Mechanism& of) {
      if (i >= static_cast<int>(of.links.size()) || of.links.size() < 3 || !isTip(of, i))
        return false;
      cutTip(of, i);
      return true;
    });
  each(&Mechanism::closures);
  each(&Mechanism::acceleration_constraints);
  each(&Mechanism::springs);
  each(&Mechanism::wrenches);
  out.push_back([](Mechanism& of) {
    const bool had = of.has_gravity;
    of.has_gravity = false;
    of.gravity = {};
    return had;
  });
  out.push_back([](Mechanism& of) { return of.has_gravity && setTo(of.gravity, 0, 0, -10); });
  return out;
}

/// What a joint has, and where it stands.
void addJointChanges(std::size_t i, std::vector<Change>* out) {
  const auto add = [&](auto change) {
    out->push_back(
        [i, change](Mechanism& m) { return i < m.links.size() && change(m, m.links[i]); });
  };
  for (const JointKind kind : {JointKind::kFixed, JointKind::kPrismatic, JointKind::kRevolute})
    add([kind](Mechanism& m, Link& link) {
      const JointKind was = link.joint.kind;
      const bool is_plainer = kind == JointKind::kFixed
                                  ? was != JointKind::kFixed
                                  : was != JointKind::kFixed && was != JointKind::kPrismatic &&
                                        was != JointKind::kRevolute;
      if (is_plainer) makeKind(m, link, kind);
      return is_plainer;
    });
  add([](Mechanism&, Link& link) {
    const bool had = link.joint.mimic.has_value();
    link.joint.mimic.reset();
    return had;
  });
  add([](Mechanism&, Link& link) {
    const bool had = !link.joint.motion.empty();
    link.joint.motion.clear();
    return had;
  });
  add([](Mechanism&, Link& link) {
    const bool had = !link.joint.rotors.empty();
    if (had) link.joint.rotors.pop_back();
    return had;
  });
  add([](Mechanism&, Link& link) {
    const bool had = link.joint.gyroscopic;
    link.joint.gyroscopic = false;
    return had;
  });
  add([](Mechanism&, Link& link) {
    const bool inertia = setTo(link.joint.rotor_inertia, 0),
               ratio = setTo(link.joint.gear_ratio, 1);
    link.joint.gyroscopic = false;
    return inertia || ratio;
  });
  add([](Mechanism&, Link& link) {
    const bool had = !link.joint.friction.isNone();
    link.joint.friction = {};
    return had;
  });
  add([](Mechanism&, Link& link) {
    const bool stiffness = setTo(link.joint.stiffness, 0), rest = setTo(link.joint.rest, 0);
    return stiffness || rest;
  });
  add([](Mechanism&, Link& link) {
    scene::Placement& p = link.joint.placement;
    if (p.convention == scene::Placement::Convention::kXyzRpy) return false;
    p = {};
    return true;
  });
  add([](Mechanism&, Link& link) { return setTo(link.joint.placement.rpy, 0, 0, 0); });
  add([](Mechanism&, Link& link) { return setTo(link.joint.placement.xyz, 0, 0, 0); });
  add([](Mechanism&, Link& link) {
    return scene::hasAxis(link.joint.kind) &&
           link.joint.placement.convention == scene::Placement::Convention::kXyzRpy &&
           setTo(link.joint.axis, 0, 0, 1);
  });
}

/// What a link weighs.
void addInertiaChanges(std::size_t i, std::vector<Change>* out) {
  const auto add = [&](auto change) {
    out->push_back(
        [i, change](Mechanism& m) { return i < m.links.size() && change(m.links[i].inertia); });
  };
  using Inertia = scene::MassProperties;
  add([](Inertia& of) {
    const bool had = !of.mass.isLiteralZero();
    of = Inertia{};
    return had;
  });
  add([](Inertia& of) {
    const bool had = of.about != Inertia::About::kCenterOfMass;
    of.about = Inertia::About::kCenterOfMass;
    return had;
  });
  add([](Inertia& of) { return setTo(of.rpy, 0, 0, 0); });
  add([](Inertia& of) {
    const bool changed[] = {setTo(of.xy, 0), setTo(of.xz, 0), setTo(of.yz, 0),
                            setTo(of.xx, 0), setTo(of.yy, 0), setTo(of.zz, 0)};
    return std::any_of(std::begin(changed), std::end(changed), [](bool x) { return x; });
  });
  add([](Inertia& of) {
    const bool products[] = {setTo(of.xy, 0), setTo(of.xz, 0), setTo(of.yz, 0)};
    return products[0] || products[1] || products[2];
  });
  add([](Inertia& of) {
    if (of.xx.isLiteralZero() && of.yy.isLiteralZero() && of.zz.isLiteralZero()) return false;
    const bool moments[] = {setTo(of.xx, 1), setTo(of.yy, 1), setTo(of.zz, 1)};
    return moments[0] || moments[1] || moments[2];
  });
  add([](Inertia& of) { return setTo(of.com, 0, 0, 0); });
  add([](Inertia& of) { return !of.mass.isLiteralZero() && setTo(of.mass, 1); });
}

/// Every number that is no 0, 1 or 2 yet.
void addNumberChanges(std::size_t i, std::vector<Change>* out) {
  const auto add = [&](auto number_of) {
    for (const int value : {1, 2})
      out->push_back([i, number_of, value](Mechanism& m) {
        if (i >= m.links.size()) return false;
        Number& x = number_of(m.links[i]);
        if (x.isLiteralZero() || x.text() == "1" || x.text() == "2") return false;
        return setTo(x, value);
      });
  };
  for (std::size_t k = 0; k < 3; ++k) {
    add([k](Link& link) -> Number& { return link.joint.placement.xyz[k]; });
    add([k](Link& link) -> Number& { return link.joint.placement.rpy[k]; });
    add([k](Link& link) -> Number& { return link.joint.axis[k]; });
    add([k](Link& link) -> Number& { return link.inertia.com[k]; });
  }
  for (Number scene::Placement::*dh : {&scene::Placement::a, &scene::Placement::alpha,
                                       &scene::Placement::d, &scene::Placement::theta})
    add([dh](Link& link) -> Number& { return link.joint.placement.*dh; });
  for (Number scene::MassProperties::*of :
       {&scene::MassProperties::mass, &scene::MassProperties::xx, &scene::MassProperties::yy,
        &scene::MassProperties::zz})
    add([of](Link& link) -> Number& { return link.inertia.*of; });
  for (Number scene::Joint::*of :
       {&scene::Joint::rotor_inertia, &scene::Joint::gear_ratio, &scene::Joint::stiffness,
        &scene::Joint::rest, &scene::Joint::pitch})
    add([of](Link& link) -> Number& { return link.joint.*of; });
  for (Number scene::Friction::*of :
       {&scene::Friction::viscous, &scene::Friction::positive, &scene::Friction::negative})
    add([of](Link& link) -> Number& { return link.joint.friction.*of; });
}

std::vector<Change> changesOf(const Mechanism& m) {
  std::vector<Change> out = partsOf(m);
  for (std::size_t i = m.links.size(); i-- > 1;) addJointChanges(i, &out);
  for (std::size_t i = m.links.size(); i-- > 0;) addInertiaChanges(i, &out);
  for (std::size_t i = m.links.size(); i-- > 0;) addNumberChanges(i, &out);
  return out;
}

/// As its own file says it; none: that is refused.
std::optional<Scene> asFile(Scene scene) {
  const Mechanism& m = scene.mechanism;
  if (static_cast<int>(scene.start_q.size()) != m.positions()) scene.start_q = m.restPosition();
  scene.start_qd.resize(static_cast<std::size_t>(m.dof()), Number(0));
  try {
    Scene read = scene::readSceneToml(scene::writeSceneToml(scene), scene.file);
    read.name = scene.name;
    return read;
  } catch (const scene::InputError&) {
    return std::nullopt;
  }
}

}  // namespace

SmallerScene smaller(const Scene& scene, const std::function<bool(const Scene&)>& shows, int most) {
  const auto doesShow = [&](const Scene& one) {
    try {
      return shows(one);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception&) {
      return false;
    }
  };
  if (!doesShow(scene)) throw std::invalid_argument("smaller: the scene itself does not show it");
  SmallerScene out{scene, 1, false};
  for (bool helped = true; helped;) {
    helped = false;
    for (const Change& change : changesOf(out.scene.mechanism)) {
      Scene tried = out.scene;
      if (!change(tried.mechanism)) continue;
      const std::optional<Scene> file = asFile(tried);
      if (!file) continue;
      if (out.trials >= most) return out;
      ++out.trials;
      if (!doesShow(*file)) continue;
      out.scene = *file;
      helped = true;
    }
  }
  out.is_smallest = true;
  return out;
}

}  // namespace dynwitness::crosscheck
