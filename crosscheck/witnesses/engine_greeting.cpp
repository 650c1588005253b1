// SPDX-License-Identifier: GPL-3.0-or-later
#include "crosscheck/witnesses/engine_greeting.hpp"

#include "crosscheck/witnesses/engine_protocol.hpp"
#include "crosscheck/witnesses/engine_words.hpp"
#include "crosscheck/witnesses/outside_claims.hpp"
#include "crosscheck/witnesses/told_numbers.hpp"
#include "scene/numbers.hpp"

namespace dynwitness::crosscheck {
namespace engine {
namespace {

/// The numbers of a scene as JSON, rounded once.
class Resolved {
 public:
  explicit Resolved(const scene::Mechanism& mechanism) : number_(mechanism) {}

  Json operator()(const scene::Number& x) const { return static_cast<double>(number_(x)); }
  Json vector(const scene::Vector& v) const { return of(number_.vector(v)); }
  Json unit(const scene::Vector& v) const { return of(number_.vector(v).normalized()); }

  /// Frame to frame: x_outer = R x_inner + p.
  Json frame(const std::vector<scene::Step>& steps) const {
    const ToldNumbers::Frame X = number_.frame(steps);
    return {{"R", of(X.R)}, {"p", of(X.p)}};
  }
  Json inertia(const scene::MassProperties& given) const {
    const ToldNumbers::Inertia told = number_.inertia(given);
    return {
        {"mass", static_cast<double>(told.mass)}, {"com", of(told.com)}, {"inertia", of(told.I)}};
  }

 private:
  static Json of(const ToldNumbers::Vector3& v) {
    Json out = Json::array();
    for (int i = 0; i < 3; ++i) out.push_back(static_cast<double>(v(i)));
    return out;
  }
  static Json of(const ToldNumbers::Matrix3& m) {
    using Row = ToldNumbers::Vector3;
    return {of(Row(m.row(0))), of(Row(m.row(1))), of(Row(m.row(2)))};
  }

  ToldNumbers number_;
};

Json jointJson(const scene::Joint& joint, const Resolved& number, int q, int qd) {
  Json out = {{"name", joint.name},
              {"kind", scene::name(joint.kind)},
              {"q", q},
              {"positions", scene::positionSlots(joint.kind).size()},
              {"qd", qd},
              {"rates", scene::degreesOfFreedom(joint.kind)},
              {"before", number.frame(joint.placement.beforeJoint())},
              {"after", number.frame(joint.placement.afterJoint())}};
  if (scene::hasAxis(joint.kind)) out["axis"] = number.unit(joint.axis);
  if (joint.kind == scene::JointKind::kHelical) out["pitch"] = number(joint.pitch);
  out["rotor_inertia"] = number(joint.rotor_inertia);
  out["gear_ratio"] = number(joint.gear_ratio);
  out["gyroscopic"] = joint.gyroscopic;
  out["viscous"] = number(joint.friction.viscous);
  out["coulomb"] = {number(joint.friction.positive), number(joint.friction.negative)};
  out["stiffness"] = number(joint.stiffness);
  out["rest"] = number(joint.rest);
  return out;
}

Json sceneJson(const scene::Scene& scene) {
  const scene::Mechanism& mechanism = scene.mechanism;
  const Resolved number(mechanism);
  Json joints = Json::array(), links = Json::array(), wrenches = Json::array();
  int q = 0, qd = 0;
  for (const scene::Link& link : mechanism.links) {
    Json one = {{"name", link.name}, {"parent", link.parent}};
    one.update(number.inertia(link.inertia));
    if (link.parent >= 0) one["joint"] = jointJson(link.joint, number, q, qd);
    const int rates = scene::degreesOfFreedom(link.joint.kind);
    if (rates > 0) joints.push_back(link.joint.name);
    q += static_cast<int>(scene::positionSlots(link.joint.kind).size());
    qd += rates;
    links.push_back(one);
  }
  for (const scene::Wrench& w : mechanism.wrenches)
    wrenches.push_back({{"link", w.link},
                        {"axes", w.axes == scene::Wrench::Axes::kLink ? "link" : "world"},
                        {"force", number.vector(w.force)},
                        {"moment", number.vector(w.moment)},
                        {"at", number.vector(w.at)}});
  const scene::Vector zero{scene::Number(0), scene::Number(0), scene::Number(0)};
  return {{"name", scene.name},
          {"positions", q},
          {"dof", qd},
          {"joints", joints},
          {"gravity", number.vector(mechanism.has_gravity ? mechanism.gravity : zero)},
          {"links", links},
          {"wrenches", wrenches},
          {"toml", scene::writeSceneToml(scene)}};
}

}  // namespace

std::vector<std::string> askable() {
  std::vector<std::string> out;
  for (const Quantity quantity : kAskable) out.emplace_back(crosscheck::name(quantity));
  out.emplace_back(kJacobian);
  return out;
}

}  // namespace engine

std::string greetingOf(const scene::Scene& scene) {
  std::vector<std::string> asks = engine::askable();
  asks.emplace_back(engine::kModel);
  const engine::Json greeting = {
      {"protocol", kEngineProtocol}, {"asks", asks}, {"scene", engine::sceneJson(scene)}};
  return greeting.dump(-1, ' ', false, engine::Json::error_handler_t::replace);
}

}  // namespace dynwitness::crosscheck
