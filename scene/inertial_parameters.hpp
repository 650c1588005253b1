// SPDX-License-Identifier: GPL-3.0-or-later
// The numbers that joint forces are linear in: which there are, and in which order. Data only: how
// a force depends on them is each witness's own business.
#pragma once

#include <string>
#include <vector>

#include "scene/mechanism.hpp"

namespace dynwitness::scene {

/// One of the ten numbers of a link, all in the axes of its frame: the mass m [kg], the first
/// moment h = m c [kg m], the inertia about the frame's origin, I = [xx xy xz; xy yy yz; xz yz zz]
/// [kg m^2]; or the inertia d = gear_ratio^2 rotor_inertia of a joint's rotor at the joint; of a
/// rotor geared to several rates (scene::Rotor) its own inertia J.
struct InertialParameter {
  enum class Kind { kMass, kHx, kHy, kHz, kIxx, kIyy, kIzz, kIxy, kIxz, kIyz, kRotor };
  int link;  ///< of the mechanism: the link, or the one that the joint with the rotor carries
  Kind kind;
  int rotor = -1;  ///< of kRotor: which of the joint's `rotors`; -1: its rotor_inertia
};
/// The ten of a link, in order.
inline constexpr int kInertialParametersOfLink = 10;

/** All of them: ten for each link that joints move, then one for each rotor that the scene
    mentions. Links that rest in the world have none: they need no force. */
std::vector<InertialParameter> inertialParameters(const Mechanism& mechanism);

/// "m", "mcx", ..., "Ixx", ..., "rotor"
const char* name(InertialParameter::Kind kind);
/// "kg", "kg m", "kg m^2"; a rotor of a slide counts in kg
std::string unit(const InertialParameter& parameter, const Mechanism& mechanism);
/// "Ixx(forearm)", "rotor(joint_2)"
std::string label(const InertialParameter& parameter, const Mechanism& mechanism);

}  // namespace dynwitness::scene
