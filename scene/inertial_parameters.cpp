// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/inertial_parameters.hpp"

namespace dynwitness::scene {

std::vector<InertialParameter> inertialParameters(const Mechanism& mechanism) {
  std::vector<InertialParameter> all;
  std::vector<bool> moves(mechanism.links.size(), false);
  for (std::size_t i = 0; i < mechanism.links.size(); ++i) {
    const Link& link = mechanism.links[i];
    moves[i] = link.parent >= 0 && (moves[link.parent] || degreesOfFreedom(link.joint.kind) > 0);
    for (int k = 0; moves[i] && k < kInertialParametersOfLink; ++k)
      all.push_back({static_cast<int>(i), static_cast<InertialParameter::Kind>(k)});
  }
  for (const int i : mechanism.movingLinks()) {
    const Joint& joint = mechanism.links[i].joint;
    if (!joint.rotor_inertia.isLiteralZero()) all.push_back({i, InertialParameter::Kind::kRotor});
    for (std::size_t k = 0; k < joint.rotors.size(); ++k)
      all.push_back({i, InertialParameter::Kind::kRotor, static_cast<int>(k)});
  }
  return all;
}

const char* name(InertialParameter::Kind kind) {
  static constexpr const char* kNames[] = {"m",   "mcx", "mcy", "mcz", "Ixx",  "Iyy",
                                           "Izz", "Ixy", "Ixz", "Iyz", "rotor"};
  return kNames[static_cast<int>(kind)];
}

std::string unit(const InertialParameter& parameter, const Mechanism& mechanism) {
  using Kind = InertialParameter::Kind;
  const bool slides = mechanism.links[parameter.link].joint.kind == JointKind::kPrismatic;
  if (parameter.kind == Kind::kMass || (parameter.kind == Kind::kRotor && slides)) return "kg";
  return parameter.kind <= Kind::kHz ? "kg m" : "kg m^2";
}

std::string label(const InertialParameter& parameter, const Mechanism& mechanism) {
  const Link& link = mechanism.links[parameter.link];
  const bool is_rotor = parameter.kind == InertialParameter::Kind::kRotor;
  const std::string which = parameter.rotor < 0 ? "" : std::to_string(parameter.rotor + 1);
  return name(parameter.kind) + which + "(" + (is_rotor ? link.joint.name : link.name) + ")";
}

}  // namespace dynwitness::scene
