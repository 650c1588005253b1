// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/inputs/scene_changes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "scene/error.hpp"
#include "scene/nearest_name.hpp"
#include "scene/numbers.hpp"
#include "scene/turn.hpp"

namespace dynwitness::crosscheck {
namespace {

using scene::Joint;
using scene::JointKind;
using scene::Link;
using scene::Mechanism;
using scene::Number;

[[noreturn]] void refuse(const std::string& why) {
  throw scene::InputError({}, why);
}

/// What --set knows of a link or a joint: where it stands.
struct Setting {
  const char* word;
  const char* values;  ///< "a number", "x,y,z"
  std::vector<Number*> (*of)(Link& link);
};
const Setting kOfLinks[] = {
    {"mass", "a number [kg]", [](Link& l) { return std::vector<Number*>{&l.inertia.mass}; }},
    {"com", "x,y,z [m]",
     [](Link& l) {
       auto& c = l.inertia.com;
       return std::vector<Number*>{&c[0], &c[1], &c[2]};
     }},
    {"inertia", "xx,yy,zz,xy,xz,yz [kg m^2] about the centre of mass, in link axes",
     [](Link& l) {
       auto& i = l.inertia;
       return std::vector<Number*>{&i.xx, &i.yy, &i.zz, &i.xy, &i.xz, &i.yz};
     }},
};
const Setting kOfJoints[] = {
    {"damping", "a number [N m s/rad, N s/m]",
     [](Link& l) { return std::vector<Number*>{&l.joint.friction.viscous}; }},
    {"coulomb", "a number [N m, N], both ways",
     [](Link& l) {
       return std::vector<Number*>{&l.joint.friction.positive, &l.joint.friction.negative};
     }},
    {"stiffness", "a number [N m/rad, N/m]",
     [](Link& l) { return std::vector<Number*>{&l.joint.stiffness}; }},
    {"rest", "a number [rad, m]", [](Link& l) { return std::vector<Number*>{&l.joint.rest}; }},
    {"rotor_inertia", "a number [kg m^2]",
     [](Link& l) { return std::vector<Number*>{&l.joint.rotor_inertia}; }},
    {"gear_ratio", "a number", [](Link& l) { return std::vector<Number*>{&l.joint.gear_ratio}; }},
};

std::vector<std::string> wordsOf(const std::string& list) {
  std::vector<std::string> words(1);
  for (const char letter : list)
    if (letter == ',')
      words.emplace_back();
    else
      words.back() += letter;
  return words;
}

/// An expression in the scene's parameters that has a finite value.
Number numberOf(const std::string& option, const std::string& text, const Mechanism& mechanism) {
  std::string reason;
  try {
    Number number = Number::parse(text);
    if (std::isfinite(scene::RealNumbers<double>(mechanism)(number))) return number;
  } catch (const scene::InputError& error) {
    reason = std::string("; ") + error.what();
  }
  refuse(
      fmt::format("{}: read '{}', allowed: a finite number, or an expression in the scene's "
                  "parameters and pi{}",
                  option, text, reason));
}

/// The one of this name, with what is nearest where there is none.
Link& named(Mechanism& mechanism, const std::string& option, const std::string& name,
            bool is_joint) {
  std::vector<std::string> all;
  for (Link& link : mechanism.links) {
    if (is_joint && link.parent < 0) continue;
    all.push_back(is_joint ? link.joint.name : link.name);
    if (all.back() == name) return link;
  }
  constexpr std::size_t kMost = 12;
  const bool more = all.size() > kMost;
  const std::string nearest = scene::didYouMean(name, all);
  all.resize(std::min(all.size(), kMost));
  refuse(fmt::format("{}: no {} '{}'{}, allowed: {}{}", option, is_joint ? "joint" : "link", name,
                     nearest, fmt::join(all, ", "),
                     more ? ", ... (dynwitness show lists them)" : ""));
}

void set(scene::Scene& scene, const std::string& word) {
  Mechanism& mechanism = scene.mechanism;
  const std::string option = fmt::format("--set {}", word);
  const std::size_t equals = word.find('='), colon = word.substr(0, equals).find(':');
  if (equals == std::string::npos)
    refuse(fmt::format("{}: no =, allowed: {}", option, fmt::join(setNames(), ", ")));
  const std::string text = word.substr(equals + 1);
  if (colon == std::string::npos) {
    const std::string name = word.substr(0, equals);
    std::vector<std::string> all;
    for (scene::Parameter& parameter : mechanism.parameters) {
      all.push_back(parameter.name);
      if (parameter.name != name) continue;
      parameter.value = numberOf(option, text, mechanism);
      return;
    }
    refuse(fmt::format("{}: no parameter '{}'{}, allowed: {}{}", option, name,
                       scene::didYouMean(name, all), fmt::join(all, ", "),
                       all.empty() ? fmt::format("{}", fmt::join(setNames(), ", ")) : ""));
  }
  const std::string what = word.substr(0, colon), name = word.substr(colon + 1, equals - colon - 1);
  const auto apply = [&](const Setting& setting, bool is_joint) {
    Link& link = named(mechanism, option, name, is_joint);
    if (is_joint && scene::degreesOfFreedom(link.joint.kind) != 1)
      refuse(fmt::format("{}: joint '{}' is {}, allowed: joints with one q", option, name,
                         scene::name(link.joint.kind)));
    const std::vector<Number*> places = setting.of(link);
    std::vector<std::string> values = wordsOf(text);
    if (what == "coulomb" && values.size() == 1) values.push_back(values[0]);
    if (values.size() != places.size())
      refuse(fmt::format("{}: read '{}', allowed: {}", option, text, setting.values));
    for (std::size_t k = 0; k < values.size(); ++k)
      *places[k] = numberOf(option, values[k], mechanism);
    if (what != "inertia") return;
    link.inertia.about = scene::MassProperties::About::kCenterOfMass;
    link.inertia.rpy = scene::Vector();
  };
  for (const Setting& setting : kOfLinks)
    if (what == setting.word) return apply(setting, false);
  for (const Setting& setting : kOfJoints)
    if (what == setting.word) return apply(setting, true);
  std::vector<std::string> words;
  for (const Setting& setting : kOfLinks) words.emplace_back(setting.word);
  for (const Setting& setting : kOfJoints) words.emplace_back(setting.word);
  refuse(fmt::format("{}: '{}' is none{}, allowed: {}", option, what,
                     scene::didYouMean(what, words), fmt::join(setNames(), ", ")));
}

void setGravity(scene::Scene& scene, const std::string& text) {
  const std::vector<std::string> values = wordsOf(text);
  if (values.size() != 3)
    refuse(fmt::format("--gravity: read '{}', allowed: x,y,z in world axes [m/s^2]", text));
  for (std::size_t k = 0; k < 3; ++k)
    scene.mechanism.gravity[k] = numberOf("--gravity", values[k], scene.mechanism);
  scene.mechanism.has_gravity = true;
}

std::string unused(const std::string& wanted, const std::vector<std::string>& taken) {
  std::string name = wanted;
  for (int k = 2; std::find(taken.begin(), taken.end(), name) != taken.end(); ++k)
    name = fmt::format("{}.{}", wanted, k);
  return name;
}

bool floatsInTheWorld(const Link& link) {
  return link.parent == 0 && link.joint.kind == JointKind::kFloating;
}

void letFloat(scene::Scene& scene) {
  Mechanism& m = scene.mechanism;
  if (std::any_of(m.links.begin(), m.links.end(), floatsInTheWorld))
    refuse("--base floating: it floats already, allowed: without");
  const auto held = [&](const std::string& what, int a, int b) {
    if (a == 0 || b == 0)
      refuse(
          fmt::format("--base floating: {} joins '{}', which would move then, allowed: scenes "
                      "that hang in the world by their joints alone",
                      what, m.links[0].name));
  };
  for (const scene::Closure& closure : m.closures)
    held(fmt::format("closure '{}'", closure.name), closure.a.link, closure.b.link);
  for (const scene::Spring& spring : m.springs)
    held(fmt::format("spring '{}'", spring.name), spring.a.link, spring.b.link);
  std::vector<std::string> links, joints;
  for (Link& link : m.links) {
    links.push_back(link.name);
    joints.push_back(link.joint.name);
    ++link.parent;
  }
  for (scene::Wrench& wrench : m.wrenches) ++wrench.link;
  for (scene::Closure& closure : m.closures) ++closure.a.link, ++closure.b.link;
  for (scene::Spring& spring : m.springs) ++spring.a.link, ++spring.b.link;
  for (scene::AccelerationConstraint& one : m.acceleration_constraints) ++one.link;
  Joint floating;
  floating.name = unused("floating_base", joints);
  floating.kind = JointKind::kFloating;
  m.links[0].joint = floating;
  Link world;
  world.name = unused("world", links);
  m.links.insert(m.links.begin(), world);
  const Number zero(0), one(1);
  scene.start_q.insert(scene.start_q.begin(), {zero, zero, zero, one, zero, zero, zero});
  scene.start_qd.insert(scene.start_qd.begin(), 6, zero);
}

void fix(scene::Scene& scene) {
  Mechanism& m = scene.mechanism;
  const scene::RealNumbers<double> number(m);
  const auto decimal = [](double x) { return Number::parse(fmt::format("{}", x == 0 ? 0.0 : x)); };
  auto q = scene.start_q.begin();
  auto qd = scene.start_qd.begin();
  bool any = false;
  for (Link& link : m.links) {
    const auto slots = static_cast<std::ptrdiff_t>(scene::positionSlots(link.joint.kind).size());
    const int rates = link.joint.ownRates();
    if (!floatsInTheWorld(link)) {
      q += slots;
      qd += rates;
      continue;
    }
    any = true;
    if (!link.joint.placement.beforeJoint().empty())
      refuse(
          fmt::format("--base fixed: joint '{}' moves from a frame of its own, allowed: one that "
                      "moves from the root's",
                      link.joint.name));
    if (!link.joint.motion.empty())
      refuse(fmt::format("--base fixed: joint '{}' is driven, allowed: one that is free",
                         link.joint.name));
    scene::Placement placement;
    for (std::size_t k = 0; k < 3; ++k) placement.xyz[k] = q[static_cast<std::ptrdiff_t>(k)];
    Eigen::Quaterniond turn(number(q[3]), number(q[4]), number(q[5]), number(q[6]));
    turn.coeffs().stableNormalize();
    const Eigen::Matrix3d R = turn.toRotationMatrix();
    const Eigen::Vector3d rpy =
        scene::rollPitchYaw(R, [](double y, double x) { return std::atan2(y, x); });
    placement.rpy = {decimal(rpy[0]), decimal(rpy[1]), decimal(rpy[2])};
    link.joint.kind = JointKind::kFixed;
    link.joint.placement = placement;
    q = scene.start_q.erase(q, q + slots);
    qd = scene.start_qd.erase(qd, qd + rates);
  }
  if (!any) refuse("--base fixed: no link floats in the world, allowed: without");
}

}  // namespace

std::vector<std::string> setNames() {
  std::vector<std::string> names;
  for (const Setting& setting : kOfLinks) names.push_back(std::string(setting.word) + ":LINK=...");
  for (const Setting& setting : kOfJoints)
    names.push_back(std::string(setting.word) + ":JOINT=...");
  names.emplace_back("PARAMETER=...");
  return names;
}

scene::Scene changed(const scene::Scene& scene, const SceneChanges& changes) {
  if (changes.isNone()) return scene;
  scene::Scene out = scene;
  out.name = scene.name + "_changed";
  out.title = scene.title + " (changed)";
  out.file = out.name;
  for (const std::string& word : changes.sets) set(out, word);
  if (!changes.gravity.empty()) setGravity(out, changes.gravity);
  if (changes.base == "floating") letFloat(out);
  if (changes.base == "fixed") fix(out);
  try {
    scene::validate(out);
  } catch (const scene::InputError& error) {
    refuse(fmt::format("{} changed by the command line: {}", scene.name, error.what()));
  }
  return out;
}

}  // namespace dynwitness::crosscheck
