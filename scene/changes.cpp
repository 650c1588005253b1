// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/changes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include "scene/error.hpp"
#include "scene/nearest_name.hpp"
#include "scene/numbers.hpp"
#include "scene/turn.hpp"
#include "scene/words.hpp"

namespace dynwitness::scene {
namespace {

[[noreturn]] void refuse(const ChangeAsGiven& as_given, const std::string& why) {
  throw InputError(as_given.where, as_given.words + ": " + why);
}

/// What --set knows of a link or a joint: where it stands.
struct Setting {
  const char* word;
  const char* values;  ///< "a number", "x,y,z"
  std::vector<Number*> (*of)(Link& link);
};
const std::vector<Setting>& ofLinks() {
  static const std::vector<Setting> kAll = {
      {"mass", "a number [kg]", [](Link& l) { return std::vector<Number*>{&l.inertia.mass}; }},
      {"com", "x,y,z [m]",
       [](Link& l) {
         auto& [x, y, z] = l.inertia.com;
         return std::vector<Number*>{&x, &y, &z};
       }},
      {"inertia", "xx,yy,zz,xy,xz,yz [kg m^2] about the centre of mass, in link axes",
       [](Link& l) {
         auto& i = l.inertia;
         return std::vector<Number*>{&i.xx, &i.yy, &i.zz, &i.xy, &i.xz, &i.yz};
       }},
  };
  return kAll;
}
const std::vector<Setting>& ofJoints() {
  static const std::vector<Setting> kAll = {
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
  return kAll;
}

/// An expression in the scene's parameters that has a finite value.
Number numberOf(const ChangeAsGiven& as_given, const std::string& text,
                const Mechanism& mechanism) {
  std::string reason;
  try {
    Number number = Number::parse(text);
    if (std::isfinite(RealNumbers<double>(mechanism)(number))) return number;
  } catch (const InputError& error) {
    reason = std::string("; ") + error.what();
  }
  refuse(as_given,
         fmt::format("read '{}', allowed: a finite number, or an expression in the scene's "
                     "parameters and pi{}",
                     text, reason));
}

/// A function of time in the scene's parameters.
Expression motionOf(const ChangeAsGiven& as_given, const std::string& text,
                    const Mechanism& mechanism) {
  std::string reason;
  try {
    Expression motion = Expression::parseOfTime(text);
    const ParameterValues values = mechanism.parameterValues();
    for (const std::string& name : motion.parameters())
      if (values.count(name) == 0) reason = fmt::format("; there is no parameter '{}'", name);
    if (reason.empty()) return motion;
  } catch (const InputError& error) {
    reason = std::string("; ") + error.what();
  }
  refuse(as_given, fmt::format("read '{}', allowed: a function of t, of pi and of the scene's "
                               "parameters{}",
                               text, reason));
}

/// The one of this name, with what is nearest where there is none.
Link& named(Mechanism& mechanism, const ChangeAsGiven& as_given, const std::string& name,
            bool is_joint) {
  std::vector<std::string> all;
  for (Link& link : mechanism.links) {
    if (is_joint && link.parent < 0) continue;
    all.push_back(is_joint ? link.joint.name : link.name);
    if (all.back() == name) return link;
  }
  constexpr std::size_t kMost = 12;
  const bool more = all.size() > kMost;
  const std::string nearest = didYouMean(name, all);
  all.resize(std::min(all.size(), kMost));
  refuse(as_given,
         fmt::format("no {} '{}'{}, allowed: {}{}", is_joint ? "joint" : "link", name, nearest,
                     fmt::join(all, ", "), more ? ", ... (dynwitness show lists them)" : ""));
}

void setParameter(Scene& scene, const std::string& name, const std::string& text,
                  const ChangeAsGiven& as_given) {
  std::vector<std::string> all;
  for (Parameter& parameter : scene.mechanism.parameters) {
    all.push_back(parameter.name);
    if (parameter.name != name) continue;
    parameter.value = numberOf(as_given, text, scene.mechanism);
    return;
  }
  refuse(as_given, fmt::format("no parameter '{}'{}, allowed: {}{}", name, didYouMean(name, all),
                               fmt::join(all, ", "),
                               all.empty() ? fmt::format("{}", fmt::join(setNames(), ", ")) : ""));
}

/// A driven joint: one function of t a position.
void setMotion(Mechanism& mechanism, const std::string& joint, const std::string& text,
               const ChangeAsGiven& as_given) {
  Link& link = named(mechanism, as_given, joint, true);
  const JointKind kind = link.joint.kind;
  if (link.joint.mimic || degreesOfFreedom(kind) == 0 || !ratesArePositionDerivatives(kind))
    refuse(as_given,
           fmt::format(
               "joint '{}' {}, allowed: joints whose rates are derivatives of their q", joint,
               link.joint.mimic ? "follows another one" : std::string("is ") + scene::name(kind)));
  const std::vector<std::string> functions = splitAtCommas(text);
  if (static_cast<int>(functions.size()) != degreesOfFreedom(kind))
    refuse(as_given, fmt::format("read '{}', allowed: one function of t a position, {}", text,
                                 degreesOfFreedom(kind)));
  std::vector<Expression> motion;
  motion.reserve(functions.size());
  for (const std::string& function : functions)
    motion.push_back(motionOf(as_given, function, mechanism));
  link.joint.motion = motion;
}

void setValues(Mechanism& mechanism, const Setting& setting, bool is_joint, const std::string& name,
               const std::string& text, const ChangeAsGiven& as_given) {
  Link& link = named(mechanism, as_given, name, is_joint);
  if (is_joint && degreesOfFreedom(link.joint.kind) != 1)
    refuse(as_given, fmt::format("joint '{}' is {}, allowed: joints with one q", name,
                                 scene::name(link.joint.kind)));
  const std::vector<Number*> places = setting.of(link);
  std::vector<std::string> values = splitAtCommas(text);
  if (std::string_view(setting.word) == "coulomb" && values.size() == 1)
    values.push_back(values[0]);
  if (values.size() != places.size())
    refuse(as_given, fmt::format("read '{}', allowed: {}", text, setting.values));
  for (std::size_t k = 0; k < values.size(); ++k)
    *places[k] = numberOf(as_given, values[k], mechanism);
  if (!as_given.where.file.empty()) link.where = as_given.where;
  if (std::string_view(setting.word) != "inertia") return;
  link.inertia.about = MassProperties::About::kCenterOfMass;
  link.inertia.rpy = Vector();
}

void setGravity(Scene& scene, const std::string& text) {
  const ChangeAsGiven as_given{"--gravity", {}};
  const std::vector<std::string> values = splitAtCommas(text);
  if (values.size() != 3)
    refuse(as_given, fmt::format("read '{}', allowed: x,y,z in world axes [m/s^2]", text));
  for (std::size_t k = 0; k < 3; ++k)
    scene.mechanism.gravity[k] = numberOf(as_given, values[k], scene.mechanism);
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

void letFloat(Scene& scene, const ChangeAsGiven& as_given) {
  Mechanism& m = scene.mechanism;
  if (std::any_of(m.links.begin(), m.links.end(), floatsInTheWorld))
    refuse(as_given, "it floats already, allowed: without");
  const auto held = [&](const std::string& what, int a, int b) {
    if (a == 0 || b == 0)
      refuse(as_given,
             fmt::format("{} joins '{}', which would move then, allowed: scenes that hang "
                         "in the world by their joints alone",
                         what, m.links[0].name));
  };
  for (const Closure& closure : m.closures)
    held(fmt::format("closure '{}'", closure.name), closure.a.link, closure.b.link);
  for (const Spring& spring : m.springs)
    held(fmt::format("spring '{}'", spring.name), spring.a.link, spring.b.link);
  std::vector<std::string> links, joints;
  for (Link& link : m.links) {
    links.push_back(link.name);
    joints.push_back(link.joint.name);
    ++link.parent;
  }
  for (Wrench& wrench : m.wrenches) ++wrench.link;
  for (Closure& closure : m.closures) ++closure.a.link, ++closure.b.link;
  for (Spring& spring : m.springs) ++spring.a.link, ++spring.b.link;
  for (AccelerationConstraint& one : m.acceleration_constraints) ++one.link;
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

void fix(Scene& scene, const ChangeAsGiven& as_given) {
  Mechanism& m = scene.mechanism;
  const RealNumbers<double> number(m);
  const auto decimal = [](double x) { return Number::parse(fmt::format("{}", x == 0 ? 0.0 : x)); };
  auto q = scene.start_q.begin();
  auto qd = scene.start_qd.begin();
  bool any = false;
  for (Link& link : m.links) {
    const auto slots = static_cast<std::ptrdiff_t>(positionSlots(link.joint.kind).size());
    const int rates = link.joint.ownRates();
    if (!floatsInTheWorld(link)) {
      q += slots;
      qd += rates;
      continue;
    }
    any = true;
    if (!link.joint.placement.beforeJoint().empty())
      refuse(as_given, fmt::format("joint '{}' moves from a frame of its own, allowed: one that "
                                   "moves from the root's",
                                   link.joint.name));
    if (!link.joint.motion.empty())
      refuse(as_given,
             fmt::format("joint '{}' is driven, allowed: one that is free", link.joint.name));
    Placement placement;
    for (std::size_t k = 0; k < 3; ++k) placement.xyz[k] = q[static_cast<std::ptrdiff_t>(k)];
    Eigen::Quaterniond turn(number(q[3]), number(q[4]), number(q[5]), number(q[6]));
    turn.coeffs().stableNormalize();
    const Eigen::Matrix3d R = turn.toRotationMatrix();
    const Eigen::Vector3d rpy =
        rollPitchYaw(R, [](double y, double x) { return std::atan2(y, x); });
    placement.rpy = {decimal(rpy[0]), decimal(rpy[1]), decimal(rpy[2])};
    link.joint.kind = JointKind::kFixed;
    link.joint.placement = placement;
    q = scene.start_q.erase(q, q + slots);
    qd = scene.start_qd.erase(qd, qd + rates);
  }
  if (!any) refuse(as_given, "no link floats in the world, allowed: without");
}

}  // namespace

std::vector<std::string> setNames() {
  std::vector<std::string> names;
  for (const Setting& setting : ofLinks()) names.push_back(std::string(setting.word) + ":LINK=...");
  for (const Setting& setting : ofJoints())
    names.push_back(std::string(setting.word) + ":JOINT=...");
  names.emplace_back("motion:JOINT=...");
  names.emplace_back("PARAMETER=...");
  return names;
}

void setNumber(Scene& scene, const std::string& name, const std::string& text,
               const ChangeAsGiven& as_given) {
  const std::size_t colon = name.find(':');
  if (colon == std::string::npos) return setParameter(scene, name, text, as_given);
  const std::string what = name.substr(0, colon), owner = name.substr(colon + 1);
  if (what == "motion") return setMotion(scene.mechanism, owner, text, as_given);
  std::vector<std::string> words = {"motion"};
  for (const bool is_joint : {false, true})
    for (const Setting& setting : is_joint ? ofJoints() : ofLinks()) {
      if (what == setting.word)
        return setValues(scene.mechanism, setting, is_joint, owner, text, as_given);
      words.emplace_back(setting.word);
    }
  refuse(as_given, fmt::format("'{}' is none{}, allowed: {}", what, didYouMean(what, words),
                               fmt::join(setNames(), ", ")));
}

void setBase(Scene& scene, const std::string& base, const ChangeAsGiven& as_given) {
  if (base == "floating")
    letFloat(scene, as_given);
  else if (base == "fixed")
    fix(scene, as_given);
  else
    refuse(as_given, fmt::format("read '{}', allowed: floating, fixed", base));
}

Scene changed(const Scene& scene, const Changes& changes, InertiaNeed need) {
  if (changes.isNone()) return scene;
  Scene out = scene;
  out.name = scene.name + "_changed";
  out.title = scene.title + " (changed)";
  out.file = out.name;
  for (const std::string& word : changes.sets) {
    const ChangeAsGiven as_given{fmt::format("--set {}", word), {}};
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos)
      refuse(as_given, fmt::format("no =, allowed: {}", fmt::join(setNames(), ", ")));
    setNumber(out, word.substr(0, equals), word.substr(equals + 1), as_given);
  }
  if (!changes.gravity.empty()) setGravity(out, changes.gravity);
  if (!changes.base.empty()) setBase(out, changes.base, {"--base " + changes.base, {}});
  try {
    validate(out, need);
  } catch (const InputError& error) {
    throw InputError({},
                     fmt::format("{} changed by the command line: {}", scene.name, error.what()));
  }
  return out;
}

}  // namespace dynwitness::scene
