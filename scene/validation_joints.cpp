// SPDX-License-Identifier: GPL-3.0-or-later
// Whether joints have an axis, and what acts at them is possible.
#include <algorithm>

#include <fmt/format.h>

#include "scene/validator.hpp"

namespace dynwitness::scene::validation {

void Validator::requireJoint(const Link& link) {
  const Joint& joint = link.joint;
  if (joint.kind == JointKind::kFixed) return;
  const auto shown = [this](const Number& n) {
    return fmt::format("{}", exactValue(n, values_).toDouble());
  };
  const bool has_axis = std::any_of(joint.axis.begin(), joint.axis.end(), [this](const Number& n) {
    return !exactValue(n, values_).isZero();
  });
  if (!has_axis) failJoint(link, "axis is [0, 0, 0], allowed: any length but zero");
  const bool is_standard = joint.placement.convention == Placement::Convention::kXyzRpy;
  if (!is_standard && (!hasAxis(joint.kind) || joint.kind == JointKind::kPlanar)) {
    failJoint(link, std::string("is ") + name(joint.kind) +
                        " and stands in a Denavit-Hartenberg row, allowed: xyz and rpy");
  }
  if (degreesOfFreedom(joint.kind) > 1 &&
      (value(joint.rotor_inertia) != 0 || value(joint.stiffness) != 0 ||
       !joint.friction.isNone())) {
    failJoint(
        link,
        std::string("is ") + name(joint.kind) +
            " and has a rotor, a spring or friction, allowed: only with joints of one position");
  }
  if (value(joint.rotor_inertia) < 0) {
    failJoint(link,
              "rotor_inertia is " + shown(joint.rotor_inertia) + " kg m^2, allowed: zero or more");
  }
  if (value(joint.rotor_inertia) > 0 && value(joint.gear_ratio) == 0) {
    failJoint(link, "gear_ratio is 0 with a rotor_inertia, allowed: any ratio but zero");
  }
  if (value(joint.stiffness) < 0) {
    failJoint(link, "stiffness is " + shown(joint.stiffness) + ", allowed: zero or more");
  }
  if (joint.gyroscopic && !(value(joint.rotor_inertia) > 0)) {
    failJoint(link, "gyroscopic without a rotor, allowed: with a rotor_inertia above zero");
  }
  requireRotors(link);
  const std::pair<const char*, const Number*> frictions[] = {
      {"viscous", &joint.friction.viscous},
      {"coulomb", &joint.friction.positive},
      {"coulomb.negative", &joint.friction.negative}};
  for (const auto& [key, number] : frictions) {
    if (value(*number) < 0) {
      failJoint(link, std::string("friction: ") + key + " is " + shown(*number) +
                          ", allowed: zero or more (what takes energy away)");
    }
  }
}

void Validator::requireRotors(const Link& link) {
  const Joint& joint = link.joint;
  if (joint.rotors.empty()) return;
  const int rates = degreesOfFreedom(joint.kind);
  if (rates < 2)
    failJoint(link, std::string("is ") + name(joint.kind) +
                        " and has rotors, allowed: rotor_inertia and gear_ratio, or a joint of "
                        "several rates");
  for (std::size_t i = 0; i < joint.rotors.size(); ++i) {
    const Rotor& rotor = joint.rotors[i];
    const std::string what = fmt::format("rotors: rotor {}: ", i + 1);
    const auto allZero = [this](const auto& numbers) {
      return std::all_of(numbers.begin(), numbers.end(),
                         [this](const Number& n) { return exactValue(n, values_).isZero(); });
    };
    if (!(value(rotor.inertia) > 0))
      failJoint(link, what + fmt::format("inertia is {} kg m^2, allowed: above zero",
                                         exactValue(rotor.inertia, values_).toDouble()));
    if (static_cast<int>(rotor.ratio.size()) != rates)
      failJoint(link,
                what + fmt::format("ratio has {} numbers, allowed: {}, one a rate of the joint",
                                   rotor.ratio.size(), rates));
    if (allZero(rotor.ratio))
      failJoint(link, what + "all of its ratio is 0, allowed: a rotor that some rate turns");
    if (rotor.axis && allZero(*rotor.axis))
      failJoint(link, what + "axis is [0, 0, 0], allowed: any length but zero");
  }
  const char* beside = !mechanism_.closures.empty()                   ? "closures"
                       : !mechanism_.springs.empty()                  ? "springs between points"
                       : mechanism_.isDriven()                        ? "driven joints"
                       : !mechanism_.acceleration_constraints.empty() ? "acceleration constraints"
                                                                      : nullptr;
  if (beside != nullptr)
    failJoint(link, std::string("has rotors geared to several rates, and there are ") + beside +
                        ", allowed: one or the other (both together are not modelled)");
}

}  // namespace dynwitness::scene::validation
