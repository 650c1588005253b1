// SPDX-License-Identifier: GPL-3.0-or-later
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "crosscheck/stability/family.hpp"
#include "crosscheck/stability/make_case.hpp"

namespace dynwitness::crosscheck::stability {
namespace {

template <typename T>
Arithmetic arithmeticOf(const char* name, bool rounds_state) {
  using Limits = std::numeric_limits<T>;
  return {name, Limits::epsilon() / 2.0, Limits::max(), Limits::denorm_min(), rounds_state};
}

}  // namespace

const Arithmetic& inDouble() {
  static const Arithmetic numbers = arithmeticOf<double>("double", false);
  return numbers;
}
const Arithmetic& inFloat() {
  static const Arithmetic numbers = arithmeticOf<float>("float", true);
  return numbers;
}

std::string decimalOf(double severity, bool is_whole) {
  return is_whole ? fmt::format("{:.0f}", severity) : fmt::format("{:.2e}", severity);
}

Case caseOf(const std::string& family, const std::vector<LinkWords>& links, const Words& gravity,
            const std::vector<double>& q, std::vector<double> qd, std::vector<double> tau) {
  Case out;
  scene::Scene& scene = out.scene;
  scene.name = scene.title = family;
  scene.file = family;
  scene.source = "figures chosen here";
  scene::Mechanism& m = scene.mechanism;
  m.has_gravity = true;
  m.gravity = vectorOf(gravity);
  m.links.emplace_back().name = "base";
  for (const LinkWords& words : links) {
    scene::Link link;
    link.name = fmt::format("link{}", m.links.size());
    link.parent = words.parent;
    link.joint.name = fmt::format("joint{}", m.links.size());
    link.joint.kind = words.joint;
    link.joint.placement.xyz = vectorOf(words.xyz);
    link.joint.axis = vectorOf(words.axis);
    link.joint.rotor_inertia = number(words.rotor);
    link.joint.gear_ratio = number(words.gear);
    scene::MassProperties& i = link.inertia;
    i.mass = number(words.mass);
    i.com = vectorOf(words.com);
    i.xx = number(words.moments[0]);
    i.yy = number(words.moments[1]);
    i.zz = number(words.moments[2]);
    i.xy = number(words.products[0]);
    i.xz = number(words.products[1]);
    i.yz = number(words.products[2]);
    m.links.push_back(std::move(link));
  }
  scene.start_q = m.restPosition();
  scene.start_qd.assign(static_cast<std::size_t>(m.dof()), scene::Number(0));
  scene::validate(scene);
  for (const double x : q) out.state.x.push_back(scene::jointPosition(x));
  qd.resize(static_cast<std::size_t>(m.dof()));
  tau.resize(static_cast<std::size_t>(m.dof()));
  out.state.qd = std::move(qd);
  out.state.qdd.assign(static_cast<std::size_t>(m.dof()), 0);
  out.state.tau = std::move(tau);
  return out;
}

const std::vector<Family>& families() {
  static const std::vector<Family> all = [] {
    std::vector<Family> out;
    for (auto* part : {familiesOfMasses, familiesOfShapes, familiesOfPoses, familiesOfMotions,
                       familiesOfConstraints, familiesOfLaws, familiesInTime}) {
      std::vector<Family> more = part();
      std::move(more.begin(), more.end(), std::back_inserter(out));
    }
    return out;
  }();
  return all;
}

}  // namespace dynwitness::crosscheck::stability
